//! The formatter: what it changes, what it keeps, and that it comes to rest.

mod common;

use common::{EXAMPLES, Random, parsed, placeless};
use expect_test::{Expect, expect};
use lapwing_diag::Code;
use lapwing_syntax::{FileId, format, parse};

fn check(text: &str, expected: Expect) {
    let once = format(text).unwrap();
    expected.assert_eq(&once);
    assert_eq!(format(&once).unwrap(), once, "a fixed point");
}

#[test]
fn every_example_comes_to_rest_and_keeps_its_placeless() {
    for (name, text) in EXAMPLES {
        let once = format(text).unwrap();
        assert_eq!(format(&once).unwrap(), once, "{name}");
        assert_eq!(placeless(&parsed(&once)), placeless(&parsed(text)), "{name}");
    }
}

#[test]
fn blanks_in_odd_places_change_nothing() {
    let mut random = Random(3);
    for (name, text) in EXAMPLES {
        let tokens = parse(FileId(0), text).tokens;
        let expected = format(text).unwrap();
        for _ in 0..20 {
            let mut spread = String::new();
            let mut end = 0;
            for token in &tokens {
                let (start, next) = (token.span.start as usize, token.span.end as usize);
                let between = &text[end..start];
                spread.push_str(between);
                if !between.is_empty() {
                    spread.push_str(random.pick(&["", "  ", "\t", " \t "]));
                }
                spread.push_str(&text[start..next]);
                end = next;
            }
            assert_eq!(format(&spread).unwrap(), expected, "{name}");
        }
    }
}

#[test]
fn blanks() {
    check(
        "x=a+b*-c-  -d/( e )\nnever x[ 3 ].y<={ 0.1 }-2m/s and not(a)or f( b ,c )\nltl( [ ]( a=>< * >b )and!( * )c )\nalways@{ x ,- 3 }==0",
        expect![[r#"
            x = a + b * -c - -d / (e)
            never x[3].y <={0.1} -2 m/s and not (a) or f(b, c)
            ltl([] (a => <*> b) and !(*) c)
            always @{x, -3} == 0
        "#]],
    );
}

#[test]
fn statements() {
    check(
        "decl  x  ns/topic   nav_msgs/msg/Odometry . pose [ 0 ]   default  -1\nworld*topics /{name}/gt PoseStamped\nfor each r in topics /{r}/odom :never r.x>1\nevent e=call A :: b\nmodel  r : position /odom O.p;\non violation of p{publish /t T{a:{},b:[1,2]} stop}",
        expect![[r#"
            decl x ns/topic nav_msgs/msg/Odometry.pose[0] default -1
            world * topics /{name}/gt PoseStamped
            for each r in topics /{r}/odom: never r.x > 1
            event e = call A::b
            model r: position /odom O.p ;
            on violation of p { publish /t T { a: {}, b: [1, 2] } stop }
        "#]],
    );
}

#[test]
fn indentation() {
    check(
        "  machine m {\n# first\nsample when a\nor b\n      state x when (c\nand d)\n  a -> b\n # last\n}\nmodel r:\nposition /odom O.p\n;\nalways (f(\na,\nb\n)\n)\nnever x >\n1\non violation of p {\npublish /t T {\na: {\nb: 1\n}\n}\nreset\n}\npattern p(a):\nalways a",
        expect![[r#"
            machine m {
                # first
                sample when a
                    or b
                state x when (c
                    and d)
                a -> b
                # last
            }
            model r:
                position /odom O.p
                ;
            always (f(
                a,
                b
            )
            )
            never x >
                1
            on violation of p {
                publish /t T {
                    a: {
                        b: 1
                    }
                }
                reset
            }
            pattern p(a):
                always a
        "#]],
    );
}

#[test]
fn comments_and_blank_lines() {
    check(
        "\n\n#one\n\n\n\n#! two   \nx = 1 # three\nlonger = 22     #four\n\ny = 1 # five\r\n# six\n\n\n",
        expect![[r#"
            # one

            #! two
            x = 1        # three
            longer = 22  # four

            y = 1  # five
            # six
        "#]],
    );
    check("", expect![""]);
    check("  \n\n", expect![""]);
    check(
        "# only",
        expect![[r#"
        # only
    "#]],
    );
}

#[test]
fn a_text_with_errors_is_refused() {
    let refused = format("never x >\nnever y").unwrap_err();
    assert_eq!(refused.iter().map(|d| d.code).collect::<Vec<_>>(), [Code::Syntax]);
}
