//! From the code of a handler to the handlers that a host program registers.
//!
//! Java does not come along: what is carried over is which functions of the robot are called, and when the monitor starts afresh. A handler that just calls
//! functions, perhaps in a loop until they succeed, becomes `run` of these; one that is more of a program becomes one `run` of a handler of its own
//! name.

use super::cursor::Cursor;
use super::lexer::Kind;
use crate::names::snake;
use crate::sheet::Action;

/// What a handler does.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Actions {
    pub actions: Vec<Action>,
    /// Whether there is code that has to be written anew.
    pub has_code: bool,
    /// Words of JavaMOP that have no counterpart.
    pub beyond: Vec<std::ops::Range<usize>>,
}

/// What a statement comes to.
enum Statement {
    Call(String),
    /// Something with more than one call in it, or none.
    Program,
    Reset,
    Stop,
    /// Text for people, or for the program's own bookkeeping.
    Idle,
}

const CONTROL: &[&str] = &["while", "for", "if", "do", "switch", "try", "synchronized", "else", "catch", "finally"];

/// Words before a bracket that are no calls, and functions that only talk or wait.
const NO_CALLS: &[&str] = &[
    "if",
    "while",
    "for",
    "switch",
    "catch",
    "return",
    "new",
    "synchronized",
    "println",
    "print",
    "printf",
    "log",
    "waitForAnyPress",
];

/// Reads a handler; `own` is what a handler of its own would be called.
pub(super) fn read(body: Cursor<'_>, own: &str) -> Actions {
    let mut all = Actions::default();
    let mut statements = Vec::new();
    let mut rest = body;
    while !rest.is_end() {
        let part = statement(&mut rest);
        statements.extend(meant(part, &mut all));
    }
    let is_program = statements.iter().any(|s| matches!(s, Statement::Program));
    let mut told = false;
    for statement in statements {
        let action = match statement {
            Statement::Call(_) | Statement::Program if is_program => {
                if std::mem::replace(&mut told, true) {
                    continue;
                }
                Action::Run(own.to_owned())
            }
            Statement::Call(name) => Action::Run(name),
            Statement::Reset => Action::Reset,
            Statement::Stop => Action::Stop,
            Statement::Program | Statement::Idle => continue,
        };
        all.has_code |= matches!(action, Action::Run(_));
        if all.actions.last() != Some(&action) {
            all.actions.push(action);
        }
    }
    // To start afresh twice, with nothing that could fail between, is to do it once.
    if all.actions.iter().all(|a| *a == Action::Reset) {
        all.actions.truncate(1);
    }
    all
}

/// The next statement: to its semicolon, or to the end of its block.
fn statement<'t>(rest: &mut Cursor<'t>) -> Cursor<'t> {
    let mut shadow = *rest;
    let is_do = shadow.peek(0) == "do";
    let controls = CONTROL.contains(&shadow.peek(0));
    let mut length = 0;
    while !shadow.is_end() {
        let before = shadow.rest().len();
        match shadow.peek(0) {
            "{" => {
                shadow.group("{", "}");
                length += before - shadow.rest().len();
                let goes_on =
                    matches!(shadow.peek(0), "else" | "catch" | "finally") || is_do && shadow.peek(0) == "while";
                if controls && goes_on || shadow.peek(0) == ")" || shadow.peek(0) == "." {
                    continue;
                }
                if shadow.peek(0) == ";" {
                    length += 1;
                }
                break;
            }
            "(" => {
                shadow.group("(", ")");
                length += before - shadow.rest().len();
            }
            ";" => {
                length += 1;
                break;
            }
            _ => {
                shadow.next();
                length += 1;
            }
        }
    }
    rest.take(length.max(1))
}

/// What a statement comes to; a reset inside of it counts after it.
fn meant(part: Cursor<'_>, all: &mut Actions) -> Vec<Statement> {
    let text = part.text;
    let words: Vec<&str> = part.rest().iter().filter_map(|t| text.get(t.range())).collect();
    let skips = part.rest().iter().filter(|t| t.kind == Kind::Word && text.get(t.range()) == Some("__SKIP"));
    all.beyond.extend(skips.map(|t| t.range()));
    let resets = words.contains(&"__RESET");
    let calls = calls(&part);
    let mut found = Vec::new();
    let exits = words.windows(4).any(|w| w == ["System", ".", "exit", "("]);
    let controls = words.first().is_some_and(|w| CONTROL.contains(w) || *w == "{");
    if exits && !controls {
        found.push(Statement::Stop);
    } else {
        let mut names: Vec<&String> = calls.iter().collect();
        names.dedup();
        let assigns = words.contains(&"=");
        found.push(match &names[..] {
            [] => Statement::Idle,
            [one] if !assigns && !exits => Statement::Call(snake(one)),
            _ => Statement::Program,
        });
    }
    if resets {
        found.push(Statement::Reset);
    }
    found
}

/// The functions that a statement calls, outside of arguments, but for those that only talk.
fn calls(part: &Cursor<'_>) -> Vec<String> {
    let text = part.text;
    let tokens = part.rest();
    let word = |at: usize| tokens.get(at).and_then(|t| text.get(t.range())).unwrap_or("");
    let controls = CONTROL.contains(&word(0));
    let mut found = Vec::new();
    let mut at = 0;
    while at < tokens.len() {
        let is_new = at.checked_sub(1).is_some_and(|before| word(before) == "new");
        let is_call = tokens.get(at).is_some_and(|t| t.kind == Kind::Word) && word(at + 1) == "(" && !is_new;
        if !is_call {
            at += 1;
            continue;
        }
        let name = word(at);
        let talks = NO_CALLS.contains(&name) && !CONTROL.contains(&name);
        if !NO_CALLS.contains(&name) {
            found.push(name.to_owned());
        }
        // What is computed for a call, or only to be told, belongs to it; in the head of a loop the calls are what it does.
        let passed = talks || !controls && !CONTROL.contains(&name);
        at += 1;
        if passed || !CONTROL.contains(&name) {
            let mut depth = 0_usize;
            while at < tokens.len() {
                depth += usize::from(word(at) == "(");
                depth = depth.saturating_sub(usize::from(word(at) == ")"));
                at += 1;
                if depth == 0 {
                    break;
                }
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::java::lexer::tokens;

    fn told(code: &str) -> String {
        let tokens = tokens(code);
        let actions = read(Cursor::new(code, &tokens), "own_violation").actions;
        let one = |action: &Action| match action {
            Action::Run(name) => format!("run {name}"),
            Action::Reset => "reset".to_owned(),
            Action::Stop => "stop".to_owned(),
        };
        actions.iter().map(one).collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn calls_become_handlers() {
        for (code, actions) in [
            ("while(!k.FindBall()); __RESET;", "run find_ball reset"),
            ("k.KickBall(); k.SetKicked(k.BallInFront()); //__RESET;", "run kick_ball run set_kicked"),
            (
                "while(!k.FindBall()){ System.out.println(\"again \"+k.FindBall()); } k.GotoGoal(true); __RESET;",
                "run find_ball run goto_goal reset",
            ),
            ("__RESET; Logger.log(F.X,\"!!! (broken)\"); while(!k.FindBall()); __RESET;", "reset run find_ball reset"),
            ("while(!k.Ready()){ Button.waitForAnyPress(); k.Init(); } __RESET;", "run own_violation reset"),
            ("while(!k.FindBall()){ k.GotoGoal(true); __RESET; }", "run own_violation reset"),
            ("System.err.println(\"x\"); System.exit(1);", "stop"),
            ("if (k.Ok()) { k.a(); } else { k.b(); } c.d();", "run own_violation"),
            ("do { k.a(); } while (x < 3); k = m;", "run a"),
            ("int n = k.count();", "run own_violation"),
            ("// nothing", ""),
            ("__RESET; __RESET;", "reset"),
            ("}}}){ ( ;;", ""),
        ] {
            assert_eq!(told(code), actions, "{code}");
        }
    }
}
