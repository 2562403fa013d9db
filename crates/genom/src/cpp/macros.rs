//! Macros, and what becomes of a text that names them.
//!
//! The expansion is Dave Prosser's algorithm, on which the C standard's is based: each token remembers which macros it came out of, and none of
//! those is expanded in it again.

use std::collections::{BTreeMap, VecDeque};
use std::rc::Rc;

use lapwing_diag::{Code, Diagnostic, FileId, Span};

use crate::lexer::lex;
use crate::token::{Kind, Token};

/// What a macro stands for.
#[derive(Clone, Debug)]
pub(crate) struct Macro {
    /// The parameters, where it is called like a function.
    pub parameters: Option<Vec<Rc<str>>>,
    /// Whether the last parameter takes all further arguments.
    pub variadic: bool,
    pub body: Vec<Token>,
}

/// The macros that a token came out of, the last one first.
type Hidden = Option<Rc<Hide>>;

#[derive(Debug)]
struct Hide {
    name: Rc<str>,
    rest: Hidden,
}

fn hides(hidden: &Hidden, name: &str) -> bool {
    let mut next = hidden;
    while let Some(hide) = next {
        if &*hide.name == name {
            return true;
        }
        next = &hide.rest;
    }
    false
}

/// All macros, and how much work expanding them has been.
#[derive(Debug, Default)]
pub(crate) struct Macros {
    pub defined: BTreeMap<Rc<str>, Macro>,
    work: usize,
}

/// A text that needs more tokens than this is not written for people: macros that multiply each other reach it in a few lines.
const MOST_WORK: usize = 2_000_000;
/// No token is longer: strings of strings, and names pasted to themselves, double with each macro.
const LONGEST: usize = 1 << 16;
/// Arguments nest no deeper.
const DEEPEST: usize = 64;

/// Why a text cannot be expanded.
pub(crate) type Failed = Box<Diagnostic>;

impl Macros {
    /// The text with all macros in it expanded.
    pub(crate) fn expand(&mut self, tokens: Vec<Token>) -> Result<Vec<Token>, Failed> {
        let is_plain = |t: &Token| t.kind != Kind::Word || !self.defined.contains_key(&t.text);
        if tokens.iter().all(is_plain) {
            return Ok(tokens);
        }
        self.run(tokens.into_iter().map(|t| (t, None)).collect(), 0)
    }

    fn run(&mut self, mut waiting: VecDeque<(Token, Hidden)>, depth: usize) -> Result<Vec<Token>, Failed> {
        let mut out = Vec::new();
        while let Some((token, hidden)) = waiting.pop_front() {
            self.work += 1;
            if self.work > MOST_WORK || depth > DEEPEST {
                return Err(too_large(token.span));
            }
            let found = (token.kind == Kind::Word && !hides(&hidden, &token.text))
                .then(|| self.defined.get(&token.text))
                .flatten();
            let Some(found) = found.cloned() else {
                out.push(token);
                continue;
            };
            let is_call = waiting.front().is_some_and(|(next, _)| next.is("("));
            let body = match &found.parameters {
                None => self.object(&found, &token)?,
                Some(_) if !is_call => {
                    out.push(token);
                    continue;
                }
                Some(parameters) => {
                    let arguments = arguments(&mut waiting, &token, parameters.len(), found.variadic)?;
                    self.substituted(&found, parameters, &arguments, &token, depth)?
                }
            };
            self.work += body.len();
            let hide = Some(Rc::new(Hide { name: token.text.clone(), rest: hidden }));
            for (number, mut inner) in body.into_iter().enumerate().rev() {
                if number == 0 {
                    (inner.spaced, inner.starts_line) = (token.spaced, token.starts_line);
                }
                waiting.push_front((inner, hide.clone()));
            }
        }
        Ok(out)
    }

    /// The body of a macro without parameters, at the place where it is named.
    fn object(&self, found: &Macro, at: &Token) -> Result<Vec<Token>, Failed> {
        let body = found.body.iter().map(|t| Token { span: at.span, starts_line: false, ..t.clone() });
        pasted(body.collect())
    }

    /// The body with arguments in place of the parameters.
    fn substituted(
        &mut self,
        found: &Macro,
        parameters: &[Rc<str>],
        arguments: &[Vec<(Token, Hidden)>],
        at: &Token,
        depth: usize,
    ) -> Result<Vec<Token>, Failed> {
        let argument = |token: &Token| {
            let number = (token.kind == Kind::Word).then(|| parameters.iter().position(|p| *p == token.text))??;
            arguments.get(number)
        };
        let mut out: Vec<Token> = Vec::new();
        for (number, token) in found.body.iter().enumerate() {
            let before = number.checked_sub(1).and_then(|n| found.body.get(n));
            let after = found.body.get(number + 1);
            let is_pasted = before.is_some_and(|t| t.is("##")) || after.is_some_and(|t| t.is("##"));
            match argument(token) {
                Some(argument) if before.is_some_and(|t| t.is("#")) => {
                    out.pop();
                    out.push(Token {
                        kind: Kind::Text,
                        text: spelt(argument, at.span)?.into(),
                        span: at.span,
                        ..token.clone()
                    });
                }
                Some(argument) if is_pasted => {
                    // An empty operand leaves nothing to paste.
                    match (argument.is_empty(), before.is_some_and(|t| t.is("##"))) {
                        (true, true) => drop(out.pop_if(|t| t.is("##"))),
                        _ => out.extend(argument.iter().map(|(t, _)| t.clone())),
                    }
                }
                Some(argument) => out.extend(self.run(argument.iter().cloned().collect(), depth + 1)?),
                None if token.is("##") && out.is_empty() => {}
                None => out.push(Token { span: at.span, starts_line: false, ..token.clone() }),
            }
            self.work += 1;
            if self.work + out.len() > MOST_WORK {
                return Err(too_large(at.span));
            }
        }
        pasted(out)
    }
}

/// The arguments of a call whose `(` comes next.
fn arguments(
    waiting: &mut VecDeque<(Token, Hidden)>,
    name: &Token,
    wanted: usize,
    variadic: bool,
) -> Result<Vec<Vec<(Token, Hidden)>>, Failed> {
    waiting.pop_front();
    let mut all = vec![Vec::new()];
    let mut depth = 0_usize;
    loop {
        let Some((token, hidden)) = waiting.pop_front() else {
            let message = format!("the call of `{}` has no closing bracket", name.text);
            return Err(Box::new(Diagnostic::new(Code::BadDirective, name.span, message)));
        };
        let is_last = variadic && all.len() == wanted;
        if token.is(")") && depth == 0 {
            break;
        } else if token.is(",") && depth == 0 && !is_last {
            all.push(Vec::new());
            continue;
        }
        depth = if token.is("(") { depth + 1 } else { depth - usize::from(token.is(")")) };
        if let Some(last) = all.last_mut() {
            last.push((token, hidden));
        }
    }
    if variadic && all.len() + 1 == wanted {
        all.push(Vec::new());
    }
    let is_empty = wanted == 0 && all.len() == 1 && all.first().is_some_and(Vec::is_empty);
    if all.len() != wanted && !is_empty {
        let message = format!("`{}` takes {wanted} arguments and is given {}", name.text, all.len());
        return Err(Box::new(Diagnostic::new(Code::BadDirective, name.span, message)));
    }
    Ok(all)
}

/// The text of an argument as a string.
fn spelt(argument: &[(Token, Hidden)], place: Span) -> Result<String, Failed> {
    let mut text = String::new();
    for (number, (token, _)) in argument.iter().enumerate() {
        if number > 0 && token.spaced {
            text.push(' ');
        }
        text += &token.text;
    }
    if text.len() > LONGEST {
        return Err(too_large(place));
    }
    Ok(format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\"")))
}

/// Carries out every `##`.
fn pasted(tokens: Vec<Token>) -> Result<Vec<Token>, Failed> {
    if !tokens.iter().any(|t| t.is("##")) {
        return Ok(tokens);
    }
    let mut out: Vec<Token> = Vec::new();
    let mut tokens = tokens.into_iter();
    while let Some(token) = tokens.next() {
        let right = if token.is("##") { tokens.next() } else { None };
        match (right, out.pop_if(|_| token.is("##"))) {
            (Some(right), Some(left)) => {
                let text = format!("{}{}", left.text, right.text);
                if text.len() > LONGEST {
                    return Err(too_large(left.span));
                }
                let joint = lex(FileId::default(), &text);
                let [one] = joint.as_slice() else {
                    let message = format!("`{}` and `{}` make no token together", left.text, right.text);
                    return Err(Box::new(Diagnostic::new(Code::BadDirective, left.span, message)));
                };
                out.push(Token { span: left.span, starts_line: left.starts_line, spaced: left.spaced, ..one.clone() });
            }
            (Some(only), None) | (None, Some(only)) => out.push(only),
            (None, None) if token.is("##") => {}
            (None, None) => out.push(token),
        }
    }
    Ok(out)
}

fn too_large(span: Span) -> Failed {
    let message = "the macros of this text multiply each other without end";
    Box::new(
        Diagnostic::new(Code::TooLarge, span, message)
            .help(format!("what is left after {MOST_WORK} steps is given up")),
    )
}
