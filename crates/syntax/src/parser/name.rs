//! Names, topics, types, paths.

use super::{Parse, Parser};
use crate::ast::{CallPath, Ident, PathPart, Topic, TypePath};
use crate::lexer::is_name_part;
use crate::token::{Role, TokenKind};
use crate::words;
use lapwing_diag::{Code, Diagnostic, Span};

impl Parser<'_> {
    /// A name, bare or in backquotes; `what` says whose, for the message.
    pub(super) fn ident(&mut self, what: &str) -> Parse<Ident> {
        self.ident_as(Role::Name, what)
    }

    pub(super) fn ident_as(&mut self, role: Role, what: &str) -> Parse<Ident> {
        if !self.at_name() {
            return self.expected(what);
        }
        let span = self.cursor.bump(role);
        let written = self.cursor.slice(span);
        Ok(Ident { name: written.trim_matches('`').to_owned(), span })
    }

    /// Whether a name stands here.
    pub(super) fn at_name(&self) -> bool {
        matches!(self.cursor.kind(), TokenKind::Name | TokenKind::Quoted)
    }

    /// Passes over the word, if it stands here.
    pub(super) fn eat_word(&mut self, word: &str) -> bool {
        let here = self.cursor.at_word(word);
        if here {
            self.cursor.bump(Role::Keyword);
        }
        here
    }

    /// Passes over a word that must stand here.
    pub(super) fn word(&mut self, word: &str) -> Parse<()> {
        if self.eat_word(word) {
            return Ok(());
        }
        let diagnostic = self.expectation(&format!("`{word}`"));
        let slip = self.cursor.word().is_some_and(|found| words::meant(found, [word]).is_some());
        let span = self.cursor.span();
        self.complain(if slip {
            diagnostic.label(format!("did you mean `{word}`?")).fix(span, word)
        } else {
            diagnostic
        })
    }

    /// Passes over the token, if it stands here. A comma, colon or operator joins lines.
    pub(super) fn eat(&mut self, kind: TokenKind) -> bool {
        let here = self.cursor.kind() == kind;
        if here {
            let joins = !matches!(kind, TokenKind::Dot | TokenKind::ColonColon | TokenKind::Semicolon);
            let role = Role::of(kind);
            if joins {
                self.cursor.bump_joining(role)
            } else {
                self.cursor.bump(role)
            };
        }
        here
    }

    /// Passes over a token that must stand here.
    pub(super) fn token(&mut self, kind: TokenKind, what: &str) -> Parse<()> {
        if self.eat(kind) { Ok(()) } else { self.expected(what) }
    }

    /// `a.b.c`: at least one name.
    pub(super) fn dotted(&mut self, what: &str) -> Parse<Vec<Ident>> {
        let mut names = vec![self.ident(what)?];
        while self.eat(TokenKind::Dot) {
            names.push(self.ident("a name after the dot")?);
        }
        Ok(names)
    }

    /// `A::f`: at least one name.
    pub(super) fn call_path(&mut self) -> Parse<CallPath> {
        let mut segments = vec![self.ident("a function, as in `Kicker::play`")?];
        while self.eat(TokenKind::ColonColon) {
            segments.push(self.ident("a name after `::`")?);
        }
        if self.cursor.kind() == TokenKind::Dot {
            let (span, message) = (self.cursor.span(), "a function is written with `::`, as in `Kicker::play`");
            return self
                .complain(Diagnostic::new(Code::Syntax, span, message).label("not with a point").fix(span, "::"));
        }
        Ok(CallPath { segments })
    }

    /// `(a, b)`: at least one name.
    pub(super) fn name_list(&mut self, what: &str) -> Parse<Vec<Ident>> {
        let listed =
            self.bracketed(TokenKind::OpenRound, "a comma or `)`", |p| p.comma_separated(|p| p.ident(what)))?;
        listed.ok_or(super::Reported(()))
    }

    /// A topic, with its leading slash or without.
    pub(super) fn topic(&mut self, what: &str) -> Parse<Topic> {
        self.topic_of(what, |c| c == '/' || is_name_part(c))
    }

    /// A topic in which `{r}` stands for a part of the name.
    pub(super) fn topic_template(&mut self, what: &str) -> Parse<Topic> {
        self.topic_of(what, |c| matches!(c, '/' | '{' | '}') || is_name_part(c))
    }

    fn topic_of(&mut self, what: &str, belongs: impl Fn(char) -> bool) -> Parse<Topic> {
        if !matches!(self.cursor.kind(), TokenKind::Slash | TokenKind::Name) {
            return self.expected(what);
        }
        let start = self.cursor.span().start as usize;
        let rest = self.cursor.text.get(start..).unwrap_or("");
        let name = &rest[..rest.find(|c| !belongs(c)).unwrap_or(rest.len())];
        let span = Span::new(self.cursor.file, start, start + name.len());
        let proper = !name.trim_start_matches('/').is_empty() && !name.contains("//") && !name.ends_with('/');
        if !proper {
            let message = format!("`{name}` is no topic");
            let help = "the parts of a topic are names, with one slash between: `/robot1/odom`";
            return self.fail(Diagnostic::new(Code::Syntax, span, message).help(help));
        }
        self.cursor.bump_topic(start + name.len());
        if self.cursor.previous().end != span.end {
            return self.fail(Diagnostic::new(Code::Syntax, span, format!("`{name}` is no topic")));
        }
        Ok(Topic { name: name.to_owned(), span })
    }

    /// `geometry_msgs/Twist.linear.x`, `Twist`, `geometry_msgs/msg/Twist`; a path of fields may follow.
    pub(super) fn type_path(&mut self) -> Parse<TypePath> {
        let start = self.cursor.position();
        let first = self.ident_as(Role::Type, "a message type, as in `Odometry` or `nav_msgs/Odometry`")?;
        let (package, name) = self.package_and_name(first)?;
        let mut path = Vec::new();
        while let Some(part) = self.path_part()? {
            path.push(part);
        }
        Ok(TypePath { package, name, path, span: self.cursor.span_since(start) })
    }

    /// A type without a way into it, which is reported; `message` says why there is none, and `help` what to do instead.
    pub(super) fn whole_type(&mut self, message: &str, help: impl Fn(&[PathPart]) -> String) -> Parse<TypePath> {
        let ty = self.type_path()?;
        if let Some(first) = ty.path.first() {
            let start = match first {
                PathPart::Field(name) => name.span,
                PathPart::Index(_, span) => *span,
            };
            let span = Span { start: start.start, ..ty.span };
            self.report(Diagnostic::new(Code::Syntax, span, message).help(help(&ty.path)));
        }
        Ok(ty)
    }

    /// What follows the first name of a type. ROS 2 puts the kind of the definition between package and name.
    fn package_and_name(&mut self, first: Ident) -> Parse<(Option<Ident>, Ident)> {
        if !self.type_slash() {
            return Ok((None, first));
        }
        let mut name = self.ident_as(Role::Type, "the name of the type after its package")?;
        if matches!(name.name.as_str(), "msg" | "srv" | "action") && self.type_slash() {
            name = self.ident_as(Role::Type, "the name of the type after its package")?;
        }
        Ok((Some(first), name))
    }

    /// A slash between the parts of a type's name.
    fn type_slash(&mut self) -> bool {
        let here = self.cursor.kind() == TokenKind::Slash;
        if here {
            self.cursor.glue();
            self.cursor.bump(Role::Type);
            self.cursor.glue();
        }
        here
    }

    fn path_part(&mut self) -> Parse<Option<PathPart>> {
        match self.cursor.kind() {
            TokenKind::Dot => {
                self.cursor.bump(Role::Punctuation);
                Ok(Some(PathPart::Field(self.ident("the name of a field after the dot")?)))
            }
            TokenKind::OpenSquare => {
                let (index, span) = self.index()?;
                Ok(Some(PathPart::Index(index, span)))
            }
            _ => Ok(None),
        }
    }

    /// `[3]`
    pub(super) fn index(&mut self) -> Parse<(usize, Span)> {
        let start = self.cursor.position();
        self.cursor.glue();
        let index = self.bracketed(TokenKind::OpenSquare, "`]`", |p| p.integer("the number of an entry, from 0"))?;
        Ok((index.unwrap_or(0), self.cursor.span_since(start)))
    }

    /// A whole number without a unit.
    pub(super) fn integer(&mut self, what: &str) -> Parse<usize> {
        let span = self.cursor.span();
        let value = self.cursor.slice(span).parse().ok();
        match value.filter(|_| self.cursor.kind() == TokenKind::Number) {
            Some(value) => {
                self.cursor.bump(Role::Number);
                Ok(value)
            }
            None => self.expected(what),
        }
    }
}
