//! Tokens to a tree. It never fails: what cannot be read is reported, left out, and the rest is read.
//!
//! GenoM3's words are names like all others where a name stands (`task`, `port`, `s` may be types or members), so that the place alone says
//! what a word is: there is one function for each production of the grammar, and it looks no further ahead than two tokens.

mod codel;
mod component;
mod expr;
mod idl;
mod init;
mod service;

use std::rc::Rc;

use lapwing_diag::{Code, Diagnostic, Span};

use crate::ast::{Ident, Item, ScopedName};
use crate::token::{Kind, Token};

/// Types, expressions and initialisers nest no deeper.
const DEEPEST: usize = 100;
/// Nobody reads more.
const MOST_DIAGNOSTICS: usize = 100;

/// What could not be read; it has been reported.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Unread;

type Read<T> = Result<T, Unread>;

/// Words that declare types, constants and scopes, and are never names.
const RESERVED: &[&str] = &[
    "module", "FALSE", "TRUE", "unsigned", "short", "long", "fixed", "float", "double", "char", "wchar", "string",
    "wstring", "boolean", "octet", "object", "any", "const", "enum", "union", "switch", "case", "default", "struct",
    "sequence", "optional", "typedef",
];

/// Reads a specification.
pub(crate) fn parse(tokens: Vec<Token>, diagnostics: &mut Vec<Diagnostic>) -> Vec<Item> {
    let last = tokens.last().map(|t| t.span).unwrap_or_default();
    let end = Token {
        kind: Kind::End,
        text: "the end".into(),
        span: Span { start: last.end, ..last },
        starts_line: true,
        spaced: true,
    };
    let mut parser =
        Parser { tokens, end, at: 0, depth: 0, quiet_at: None, pragmas: Vec::new(), reported: 0, diagnostics };
    parser.skip_pragmas();
    parser.specification()
}

struct Parser<'a> {
    tokens: Vec<Token>,
    end: Token,
    at: usize,
    depth: usize,
    /// Where the last fault was reported: one place has one.
    quiet_at: Option<usize>,
    /// Pragmas that have been passed and are not yet in the tree.
    pragmas: Vec<Ident>,
    reported: usize,
    diagnostics: &'a mut Vec<Diagnostic>,
}

impl Parser<'_> {
    fn specification(&mut self) -> Vec<Item> {
        let mut items = Vec::new();
        loop {
            items.extend(self.pragmas.drain(..).map(Item::Pragma));
            if self.peek().kind == Kind::End {
                return items;
            }
            let before = self.at;
            match self.item() {
                Ok(item) => items.push(item),
                Err(Unread) => self.recover(),
            }
            if self.at == before {
                self.bump();
            }
        }
    }

    fn item(&mut self) -> Read<Item> {
        let item = match self.word() {
            "component" | "interface" => Item::Body(self.body()?),
            "module" => {
                self.bump();
                let name = self.name("the name of the module")?;
                let items = self.braced("module", Parser::item)?;
                Item::Module { name, items }
            }
            "native" | "exception" => Item::Decl(self.declaration()?),
            _ if self.begins_declaration() => Item::Decl(self.declaration()?),
            _ => return Err(self.expected("a component, an interface or a declaration")),
        };
        self.semicolon()?;
        Ok(item)
    }

    // What the productions are made of.

    fn peek(&self) -> &Token {
        self.tokens.get(self.at).unwrap_or(&self.end)
    }

    fn peek_second(&self) -> &Token {
        let rest = self.tokens.get(self.at + 1..).unwrap_or_default();
        rest.iter().find(|t| t.kind != Kind::Pragma).unwrap_or(&self.end)
    }

    /// The text of the next token where it is a word, else nothing.
    fn word(&self) -> &str {
        let token = self.peek();
        if token.kind == Kind::Word { &token.text } else { "" }
    }

    fn bump(&mut self) -> Token {
        let token = self.peek().clone();
        self.at = (self.at + 1).min(self.tokens.len());
        self.skip_pragmas();
        token
    }

    fn skip_pragmas(&mut self) {
        while let Some(token) = self.tokens.get(self.at).filter(|t| t.kind == Kind::Pragma) {
            self.pragmas.push(Ident { name: token.text.to_string(), span: token.span });
            self.at += 1;
        }
    }

    fn is(&self, sign: &str) -> bool {
        self.peek().is(sign)
    }

    fn eat(&mut self, sign: &str) -> bool {
        let is_it = self.is(sign);
        if is_it {
            self.bump();
        }
        is_it
    }

    fn eat_word(&mut self, word: &str) -> bool {
        let is_it = self.peek().is_word(word);
        if is_it {
            self.bump();
        }
        is_it
    }

    fn want(&mut self, sign: &str, place: &str) -> Read<Token> {
        if self.is(sign) { Ok(self.bump()) } else { Err(self.expected(&format!("`{sign}` {place}"))) }
    }

    /// The end of a declaration. Where it is missing the declaration counts all the same; what follows on its line is passed over.
    fn semicolon(&mut self) -> Read<()> {
        if self.eat(";") {
            return Ok(());
        }
        let Some(before) = self.tokens.get(self.at.saturating_sub(1)).map(|t| t.span) else {
            return Err(self.expected("`;`"));
        };
        let after = Span { start: before.end, ..before };
        let found = self.shown();
        let diagnostic =
            Diagnostic::new(Code::Syntax, before, format!("`;` is missing after this, before {found}")).fix(after, ";");
        self.report(diagnostic);
        if !self.peek().starts_line {
            self.recover();
        }
        Ok(())
    }

    /// A name: every word but those that declare types.
    fn name(&mut self, what: &str) -> Read<Ident> {
        let token = self.peek();
        if token.kind == Kind::Word && !RESERVED.contains(&&*token.text) {
            let token = self.bump();
            return Ok(Ident { name: token.text.to_string(), span: token.span });
        }
        if token.kind == Kind::Word {
            let message = format!("{what} should stand here, and `{}` is a word of the language", token.text);
            let diagnostic = Diagnostic::new(Code::ReservedWord, token.span, message);
            self.report(diagnostic);
            return Err(Unread);
        }
        Err(self.expected(what))
    }

    /// `a::b`, with `::` before it or not.
    fn scoped_name(&mut self, what: &str) -> Read<ScopedName> {
        let absolute = self.eat("::");
        let mut parts = vec![self.name(what)?];
        while self.eat("::") {
            parts.push(self.name(what)?);
        }
        Ok(ScopedName { absolute, parts })
    }

    /// One or more, with commas between.
    fn list<T>(&mut self, mut one: impl FnMut(&mut Self) -> Read<T>) -> Read<Vec<T>> {
        let mut all = vec![one(self)?];
        while self.eat(",") {
            all.push(one(self)?);
        }
        Ok(all)
    }

    /// `{ … }` with any number of things in it, each of which is read on although the one before could not be.
    fn braced<T>(&mut self, what: &str, mut one: impl FnMut(&mut Self) -> Read<T>) -> Read<Vec<T>> {
        let open = self.want("{", &format!("before what is in the {what}"))?;
        self.nested(open.span, |parser| {
            let mut all = Vec::new();
            loop {
                if parser.eat("}") {
                    return Ok(all);
                }
                if parser.peek().kind == Kind::End {
                    let message = format!("the `{{` of this {what} has no `}}`");
                    parser.report(Diagnostic::new(Code::UnclosedBracket, open.span, message));
                    return Ok(all);
                }
                let before = parser.at;
                match one(parser) {
                    Ok(one) => all.push(one),
                    Err(Unread) => parser.recover(),
                }
                if parser.at == before {
                    parser.bump();
                }
            }
        })
    }

    /// Goes one level deeper, where that is not too deep.
    fn nested<T>(&mut self, place: Span, read: impl FnOnce(&mut Self) -> Read<T>) -> Read<T> {
        if self.depth >= DEEPEST {
            let message = format!("this nests more than {DEEPEST} levels deep");
            self.report(Diagnostic::new(Code::TooDeep, place, message));
            return Err(Unread);
        }
        self.depth += 1;
        let read = read(self);
        self.depth -= 1;
        read
    }

    /// Goes behind the next `;`, or before the `}` of what is around.
    fn recover(&mut self) {
        let mut depth = 0_usize;
        loop {
            let token = self.peek();
            match token.kind {
                Kind::End => return,
                Kind::Sign if token.is("{") => depth += 1,
                Kind::Sign if token.is("}") && depth == 0 => return,
                Kind::Sign if token.is("}") => depth -= 1,
                Kind::Sign if token.is(";") && depth == 0 => {
                    self.bump();
                    return;
                }
                _ => {}
            }
            self.bump();
        }
    }

    /// The next token as a message shows it.
    fn shown(&self) -> String {
        let token = self.peek();
        match token.kind {
            Kind::End => "the end".to_owned(),
            _ => format!("`{}`", token.text.chars().take(40).collect::<String>()),
        }
    }

    /// Says what should stand here.
    fn expected(&mut self, what: &str) -> Unread {
        let (kind, span, text): (Kind, Span, Rc<str>) = {
            let token = self.peek();
            (token.kind, token.span, token.text.clone())
        };
        if self.quiet_at != Some(self.at) {
            self.quiet_at = Some(self.at);
            let diagnostic = match kind {
                Kind::Bad => Diagnostic::new(Code::StrayCharacter, span, &*text),
                _ => {
                    Diagnostic::new(Code::Syntax, span, format!("{what} should stand here, and {} does", self.shown()))
                }
            };
            self.report(diagnostic);
        }
        Unread
    }

    fn report(&mut self, diagnostic: Diagnostic) {
        self.reported += 1;
        if self.reported <= MOST_DIAGNOSTICS {
            self.diagnostics.push(diagnostic);
        }
    }
}
