//! Every code has a name that can be typed and a page that explains it.

use lapwing_diag::Code;

#[test]
fn every_code_has_a_page() {
    let bare: Vec<&str> = Code::ALL.iter().filter(|code| !has_body(code)).map(|code| code.name()).collect();
    assert!(bare.is_empty(), "pages without a body: {bare:?}");
}

fn has_body(code: &Code) -> bool {
    let page = code.page();
    let (heading, body) = page.split_once('\n').unwrap_or((page, ""));
    assert_eq!(heading, format!("# {}", code.name()), "the heading of a page is the code's name");
    body.split_whitespace().count() >= 20
}

#[test]
fn names_are_unique_and_lead_back_to_their_codes() {
    for code in Code::ALL {
        assert_eq!(Code::from_name(code.name()), Some(*code));
        assert!(code.name().bytes().all(|b| b.is_ascii_lowercase() || b == b'-'), "{}", code.name());
    }
    assert_eq!(Code::from_name("no-such-code"), None);
}
