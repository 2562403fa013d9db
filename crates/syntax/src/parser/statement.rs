//! Statements: which kind begins here, and how the parser goes on after a fault.

use super::{Parse, Parser, Reported};
use crate::ast::{ExprKind, Item, ItemKind, Setting};
use crate::token::{Role, TokenKind};
use crate::words;
use lapwing_diag::{Code, Diagnostic};

impl Parser<'_> {
    /// All statements of the file.
    pub(super) fn statements(&mut self) -> Vec<Item> {
        let mut items = Vec::new();
        while !self.cursor.at_end() {
            let start = self.cursor.position();
            let item = self.item();
            if self.end_of_statement_after(&item).is_err() {
                self.cursor.skip_statement(start, None);
                items.extend(item.ok().and_then(spoiled));
            } else {
                items.extend(item);
            }
        }
        items
    }

    fn item(&mut self) -> Parse<Item> {
        self.begin();
        let start = self.cursor.position();
        let kind = self.statement()?;
        Ok(Item { kind, span: self.cursor.span_since(start) })
    }

    /// Begins a statement, or an entry of a machine.
    pub(super) fn begin(&mut self) {
        self.cursor.begin();
        self.first = self.cursor.span();
        self.clauses = &[];
        self.symbolic = false;
        self.bare_number = None;
        self.path_end = None;
    }

    fn end_of_statement_after(&mut self, item: &Parse<Item>) -> Parse<()> {
        match item {
            Ok(_) => self.end_of_statement(),
            Err(reported) => Err(*reported),
        }
    }

    /// Nothing more stands on the line.
    pub(super) fn end_of_statement(&mut self) -> Parse<()> {
        match self.cursor.kind() {
            TokenKind::End => Ok(()),
            _ => Err(self.leftover("the end of the line")),
        }
    }

    fn statement(&mut self) -> Parse<ItemKind> {
        let name_follows = self.at_name();
        match self.cursor.ahead(1) {
            TokenKind::Equals if name_follows => return self.assignment(),
            TokenKind::Colon if self.cursor.at_word("property") => {}
            TokenKind::Colon if name_follows => return self.named_property(),
            TokenKind::Name if name_follows && self.over_follows() => return self.named_property(),
            _ => {}
        }
        match self.cursor.word() {
            Some(word) if self.begins_statement(word) => self.keyword_statement(word),
            _ => self.bare_property(),
        }
    }

    /// `NAME over (`
    fn over_follows(&self) -> bool {
        self.cursor.word_ahead(1) == Some("over") && self.cursor.ahead(2) == TokenKind::OpenRound
    }

    /// Whether the word begins a statement here rather than naming something: it is followed by what its statement needs.
    fn begins_statement(&self, word: &str) -> bool {
        let next = self.cursor.ahead(1);
        let next_word = self.cursor.word_ahead(1);
        let joined = next_word.is_some_and(|w| words::joining_words().any(|joining| joining == w));
        let name = matches!(next, TokenKind::Name | TokenKind::Quoted) && !joined;
        let missing = next == TokenKind::End && words::STATEMENTS.contains(&word);
        match word {
            "decl" | "model" | "event" | "machine" | "pattern" | "clock" => name || missing,
            "world" => name || missing || next == TokenKind::Star,
            "property" => name || missing || next == TokenKind::Colon,
            "use" => name || missing || next == TokenKind::Text,
            "guard" => name || missing || next == TokenKind::Slash,
            "on" => next_word.is_some_and(|w| words::meant(w, ["violation"]).is_some()),
            _ => false,
        }
    }

    fn keyword_statement(&mut self, word: &str) -> Parse<ItemKind> {
        self.cursor.bump(Role::Keyword);
        match word {
            "decl" => self.decl().map(ItemKind::Decl),
            "model" => self.model().map(ItemKind::Model),
            "world" => self.world().map(ItemKind::World),
            "event" => self.event().map(ItemKind::Event),
            "machine" => self.machine().map(ItemKind::Machine),
            "pattern" => self.pattern().map(ItemKind::Pattern),
            "use" => self.use_statement().map(ItemKind::Use),
            "guard" => self.guard().map(ItemKind::Guard),
            "on" => self.reaction().map(ItemKind::Reaction),
            "clock" => self.clock().map(ItemKind::Setting),
            _ => self.property(),
        }
    }

    /// `clock events`
    fn clock(&mut self) -> Parse<Setting> {
        if self.eat_word("events") {
            return Ok(Setting::ClockEvents);
        }
        let diagnostic = self.expectation("`events` after `clock`");
        self.complain(diagnostic.help("a clock of a fixed rate is set by `__rate__ = 30`"))
    }

    /// `NAME = …`: a setting, where the name is one of theirs, else a definition.
    fn assignment(&mut self) -> Parse<ItemKind> {
        match self.cursor.word().map(setting_kind) {
            Some(Some(kind)) => self.setting(kind).map(ItemKind::Setting),
            Some(None) if self.is_unknown_setting() => self.unknown_setting(),
            _ => self.definition(),
        }
    }

    fn setting(&mut self, kind: SettingKind) -> Parse<Setting> {
        self.cursor.bump(Role::Keyword);
        self.token(TokenKind::Equals, "`=`")?;
        if self.cursor.kind() == TokenKind::Minus {
            let message = "a setting is never negative";
            let diagnostic = Diagnostic::new(Code::BadSetting, self.cursor.span(), message);
            return self.fail(diagnostic);
        }
        let number = self.number()?;
        if kind == SettingKind::Rate && !(number.text.bytes().all(|b| b.is_ascii_digit()) && number.value >= 1.0) {
            let diagnostic =
                Diagnostic::new(Code::BadSetting, number.span, "a rate is a whole number of instants per second");
            self.report(diagnostic.help("write `__rate__ = 30`, or leave it out: then every message makes an instant"));
        }
        Ok(match kind {
            SettingKind::Rate => Setting::Rate(number),
            SettingKind::Timeout => Setting::Timeout(number),
            SettingKind::Margin => Setting::Margin(number),
        })
    }

    /// Whether the name looks like a setting: `__rte__`.
    fn is_unknown_setting(&self) -> bool {
        self.cursor.word().is_some_and(|word| word.len() > 4 && word.starts_with("__") && word.ends_with("__"))
    }

    fn unknown_setting(&mut self) -> Parse<ItemKind> {
        let span = self.cursor.span();
        let word = self.cursor.slice(span);
        let diagnostic = Diagnostic::new(Code::BadSetting, span, format!("there is no setting `{word}`"));
        let known = ["__rate__", "__timeout__", "__margin__"];
        let diagnostic = diagnostic.help(format!("the settings are {}", words::listed(known)));
        self.fail(match words::meant(word, known) {
            Some(meant) => diagnostic.label(format!("did you mean `{meant}`?")).fix(span, meant),
            None => diagnostic,
        })
    }

    /// A name that is about to be given: one that the language reserves is reported, and taken.
    pub(super) fn new_name(&mut self) -> Parse<crate::ast::Ident> {
        if self.cursor.word().is_some_and(|word| words::is_reserved(word) && !words::begins_nothing(word)) {
            let span = self.cursor.span();
            let quoted = format!("`{}`", self.cursor.slice(span));
            let diagnostic = self.reserved("a name").fix(span, quoted);
            self.report(diagnostic);
        }
        self.ident("a name")
    }

    /// Catches a fault in the body of a statement that begins at `start` and whose name is known.
    pub(super) fn or_rest<T>(&mut self, start: usize, result: Parse<T>, instead: impl FnOnce(&mut Self) -> T) -> T {
        result.unwrap_or_else(|Reported(())| {
            self.cursor.skip_statement(start, None);
            instead(self)
        })
    }
}

/// What is left of a statement behind which something stands that does not belong there: its name still counts, its formula
/// is not to be trusted.
fn spoiled(mut item: Item) -> Option<Item> {
    let body = match &mut item.kind {
        ItemKind::Property(property) if property.name.is_none() => return None,
        ItemKind::Property(property) => &mut property.body,
        ItemKind::Definition(definition) => &mut definition.body,
        ItemKind::Pattern(pattern) => &mut pattern.body,
        _ => return Some(item),
    };
    body.kind = ExprKind::Error;
    Some(item)
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum SettingKind {
    Rate,
    Timeout,
    Margin,
}

fn setting_kind(word: &str) -> Option<SettingKind> {
    Some(match word {
        "__rate__" | "_rate_" => SettingKind::Rate,
        "__timeout__" | "_timeout_" => SettingKind::Timeout,
        "__margin__" | "_margin_" | "_default_margin_" | "__default_margin__" => SettingKind::Margin,
        _ => return None,
    })
}
