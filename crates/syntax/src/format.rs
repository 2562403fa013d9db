//! The canonical layout of a specification.
//!
//! The author's line breaks stay: they may mean something, and long formulas are broken where their author thinks it best.
//! What changes is the blanks in a line, its indentation, and blank lines (never two in a row). So the tokens and the
//! newlines between them are the same before and after, and so is the tree.

use crate::parser::parse;
use crate::token::{Place, Token, TokenKind};
use lapwing_diag::{Diagnostic, FileId, has_errors};

/// One step of indentation.
const STEP: usize = 4;

/// A line longer than this does not push the comments of its neighbours to the right.
const COMMENT_COLUMN: usize = 60;

/// Lays a text out canonically. A text with errors is left alone: they are given back.
///
/// ```
/// let text = "limit=0.5*2 #half\nnever  x>limit";
/// assert_eq!(lapwing_syntax::format(text).unwrap(), "limit = 0.5 * 2  # half\nnever x > limit\n");
/// ```
pub fn format(text: &str) -> Result<String, Vec<Diagnostic>> {
    let parsed = parse(FileId::default(), text);
    if has_errors(&parsed.diagnostics) {
        return Err(parsed.diagnostics);
    }
    let mut lines = lines(text, &parsed.tokens);
    align_comments(&mut lines);
    Ok(lines.iter().map(Line::to_text).collect())
}

/// A line of the result.
struct Line {
    /// Whether a blank line stands before it.
    apart: bool,
    indent: usize,
    code: String,
    comment: String,
    /// How many blanks stand between the code and the comment.
    gap: usize,
}

impl Line {
    fn to_text(&self) -> String {
        let apart = if self.apart { "\n" } else { "" };
        let indent = " ".repeat(self.indent);
        let gap = " ".repeat(self.gap);
        format!("{apart}{indent}{}{gap}{}\n", self.code, self.comment)
    }

    fn width(&self) -> usize {
        self.indent + self.code.chars().count()
    }
}

/// The lines of the result, their comments not yet aligned.
fn lines(text: &str, tokens: &[Token]) -> Vec<Line> {
    let mut indentation = Indentation { open: Vec::new() };
    let mut lines: Vec<Line> = Vec::new();
    let mut end = 0;
    for (line, following) in source_lines(tokens) {
        let Some(first) = line.first() else { continue };
        let start = first.span.start as usize;
        let newlines = text.get(end..start).unwrap_or("").matches('\n').count();
        end = line.last().map_or(start, |last| last.span.end as usize);
        let indent = indentation.of(following, first.kind == TokenKind::Comment);
        indentation.pass(line, indent);
        let (code, comment) = code_and_comment(text, line);
        let gap = if code.is_empty() || comment.is_empty() { 0 } else { 2 };
        lines.push(Line { apart: newlines > 1 && !lines.is_empty(), indent, code, comment, gap });
    }
    lines
}

/// The tokens line by line, each line with the token by which it is indented: a comment goes with what it stands before.
fn source_lines(tokens: &[Token]) -> Vec<(&[Token], Option<&Token>)> {
    let mut following = None;
    let lines: Vec<&[Token]> = tokens.chunk_by(|_, next| !next.starts_line).collect();
    let mut placed: Vec<_> = lines
        .into_iter()
        .rev()
        .map(|line| {
            following = line.first().filter(|first| first.kind != TokenKind::Comment).or(following);
            (line, following)
        })
        .collect();
    placed.reverse();
    placed
}

/// The brackets that stand open: each says how far what is in it is indented.
struct Indentation {
    open: Vec<Bracket>,
}

#[derive(Clone, Copy)]
struct Bracket {
    indent: usize,
    /// Whether it holds entries, each of which may go on over several lines.
    block: bool,
}

impl Indentation {
    /// How far a line is indented that begins with `token`, or with a comment before it.
    fn of(&self, token: Option<&Token>, comment: bool) -> usize {
        let innermost = self.open.last().copied().unwrap_or(Bracket { indent: 0, block: true });
        match token {
            None => 0,
            Some(token) if token.kind.closes() && !comment => innermost.indent.saturating_sub(STEP),
            Some(token) if token.kind.closes() || token.place == Place::First => innermost.indent,
            Some(_) if innermost.block => innermost.indent + STEP,
            Some(_) => innermost.indent,
        }
    }

    /// Notes the brackets that a line opens and closes.
    fn pass(&mut self, line: &[Token], indent: usize) {
        for token in line {
            if token.kind.opens() {
                self.open.push(Bracket { indent: indent + STEP, block: token.place == Place::Block });
            } else if token.kind.closes() {
                self.open.pop();
            }
        }
    }
}

/// The code of a line with canonical blanks, and its comment.
fn code_and_comment(text: &str, line: &[Token]) -> (String, String) {
    let slice = |token: &Token| text.get(token.span.start as usize..token.span.end as usize).unwrap_or("");
    let mut code = String::new();
    let mut before: Option<&Token> = None;
    for token in line {
        if token.kind == TokenKind::Comment {
            return (code, comment(slice(token)));
        }
        if before.is_some_and(|before| blank_between(before, token)) {
            code.push(' ');
        }
        code.push_str(slice(token));
        before = Some(token);
    }
    (code, String::new())
}

/// A comment, with a blank after its sign where a word follows directly.
fn comment(written: &str) -> String {
    let written = written.trim_end();
    let rest = written.strip_prefix('#').unwrap_or(written);
    if rest.starts_with(char::is_alphanumeric) { format!("# {rest}") } else { written.to_owned() }
}

/// Whether a blank stands between two tokens of a line.
fn blank_between(before: &Token, token: &Token) -> bool {
    use TokenKind::*;
    if token.place == Place::Glued {
        return false;
    }
    let after = matches!(before.kind, OpenRound | OpenSquare | Dot | ColonColon);
    let ahead = matches!(token.kind, CloseRound | CloseSquare | Comma | Colon | ColonColon | Dot);
    let empty = (before.kind, token.kind) == (OpenCurly, CloseCurly);
    !(after || ahead || empty)
}

/// Puts the comments behind neighbouring lines of code under one another.
fn align_comments(lines: &mut [Line]) {
    for block in lines.chunk_by_mut(|line, next| line.gap > 0 && next.gap > 0 && !next.apart) {
        let short = |line: &Line| line.width() <= COMMENT_COLUMN;
        let column = block.iter().filter(|line| short(line)).map(|line| line.width() + 2).max().unwrap_or(0);
        for line in block.iter_mut().filter(|line| line.gap > 0 && short(line)) {
            line.gap = column - line.width();
        }
    }
}
