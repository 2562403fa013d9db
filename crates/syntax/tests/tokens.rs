//! What an editor gets: every sign of a text in a token, each token with what it is where it stands.

use lapwing_syntax::{Role, tokens};

/// The roles of the tokens of a text, by the first letters of their names.
fn check(text: &str, expected: &[(&str, Role)]) {
    let found: Vec<(&str, Role)> =
        tokens(text).iter().map(|t| (&text[t.span.start as usize..t.span.end as usize], t.role)).collect();
    assert_eq!(found, expected);
}

#[test]
fn words_are_keywords_only_where_they_act_as_such() {
    use Role::*;
    check(
        "never x.next > 2 m/s # fast",
        &[
            ("never", Keyword),
            ("x", Name),
            (".", Punctuation),
            ("next", Name),
            (">", Operator),
            ("2", Number),
            ("m/s", Unit),
            ("# fast", Comment),
        ],
    );
    check(
        "decl on /on/off std_msgs/Bool.data default true",
        &[
            ("decl", Keyword),
            ("on", Name),
            ("/", Topic),
            ("on", Topic),
            ("/", Topic),
            ("off", Topic),
            ("std_msgs", Type),
            ("/", Type),
            ("Bool", Type),
            (".", Punctuation),
            ("data", Name),
            ("default", Keyword),
            ("true", Keyword),
        ],
    );
}

#[test]
fn functions_topics_and_symbols() {
    use Role::*;
    check(
        "age(/scan) < 1 or ltl(<*> o)",
        &[
            ("age", Function),
            ("(", Punctuation),
            ("/", Topic),
            ("scan", Topic),
            (")", Punctuation),
            ("<", Operator),
            ("1", Number),
            ("or", Keyword),
            ("ltl", Keyword),
            ("(", Punctuation),
            ("<", Operator),
            ("*", Operator),
            (">", Operator),
            ("o", Keyword),
            (")", Punctuation),
        ],
    );
}

#[test]
fn a_text_that_is_wrong_has_tokens_too() {
    use Role::*;
    check("never x % \"a", &[("never", Keyword), ("x", Name), ("%", Bad), ("\"a", Bad)]);
}
