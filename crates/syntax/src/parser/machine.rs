//! `machine NAME { … }`: one entry per line.

use super::{Parse, Parser};
use crate::ast::{Edge, Ident, Machine, State};
use crate::token::{Role, TokenKind};
use lapwing_diag::{Code, Diagnostic};

/// The words that begin an entry.
const ENTRIES: &[&str] = &["sample", "initial", "state", "else"];

impl Parser<'_> {
    /// What follows the word `machine`.
    pub(super) fn machine(&mut self) -> Parse<Machine> {
        let name = self.ident("the machine's name")?;
        if self.cursor.kind() != TokenKind::OpenCurly {
            return self.expected("`{` after the machine's name");
        }
        self.cursor.mark_block();
        let Some(inside) = self.cursor.enter_block() else { return self.unclosed_block() };
        let mut machine =
            Machine { name, sample: None, initial: None, states: Vec::new(), else_stay: false, edges: Vec::new() };
        while !self.cursor.at_close(&inside) {
            self.begin();
            let start = self.cursor.position();
            if self.entry(&mut machine).and_then(|()| self.end_of_entry(inside)).is_err() {
                self.cursor.skip_statement(start, Some(&inside));
            }
        }
        self.cursor.leave(inside);
        Ok(machine)
    }

    /// A block that is never closed reaches to the next line that surely begins a statement.
    pub(super) fn unclosed_block<T>(&mut self) -> Parse<T> {
        let reported = self.unclosed();
        self.cursor.skip_to_statement();
        reported
    }

    fn end_of_entry(&mut self, inside: super::cursor::Inside) -> Parse<()> {
        if self.cursor.at_close(&inside) || self.cursor.kind() == TokenKind::End {
            return Ok(());
        }
        let begins_entry = self.cursor.word().is_some_and(|word| ENTRIES.contains(&word));
        if begins_entry || self.cursor.ahead(1) == TokenKind::Arrow {
            let diagnostic = self.expectation("the end of the line");
            return self.fail(diagnostic.help("each entry of a machine stands on a line of its own"));
        }
        Err(self.leftover("the end of the line"))
    }

    fn entry(&mut self, machine: &mut Machine) -> Parse<()> {
        if self.at_name() && self.cursor.ahead(1) == TokenKind::Arrow {
            return self.edges(machine);
        }
        match self.cursor.word() {
            Some("sample") => self.sample(machine),
            Some("initial") => self.initial(machine),
            Some("state") => {
                machine.states.push(self.state()?);
                Ok(())
            }
            Some("else") => self.else_stay(machine),
            _ => {
                let help = "entries are `sample when …`, `initial NAME`, `state NAME …`, `else stay` and `a -> b`";
                self.unknown_choice("an entry of the machine", ENTRIES, help)
            }
        }
    }

    /// `sample when CONDITION`
    fn sample(&mut self, machine: &mut Machine) -> Parse<()> {
        self.only_once(machine.sample.is_some());
        self.cursor.bump(Role::Keyword);
        self.word("when")?;
        machine.sample = Some(*self.formula()?);
        Ok(())
    }

    /// `initial NAME`
    fn initial(&mut self, machine: &mut Machine) -> Parse<()> {
        self.only_once(machine.initial.is_some());
        self.cursor.bump(Role::Keyword);
        machine.initial = Some(self.ident("the state in which the machine begins")?);
        Ok(())
    }

    /// `else stay`
    fn else_stay(&mut self, machine: &mut Machine) -> Parse<()> {
        self.only_once(machine.else_stay);
        self.cursor.bump(Role::Keyword);
        self.word("stay")?;
        machine.else_stay = true;
        Ok(())
    }

    /// Reports an entry that a machine has already.
    fn only_once(&mut self, given: bool) {
        if given {
            let span = self.cursor.span();
            let message = format!("a machine has one `{}` entry", self.cursor.slice(span));
            self.report(Diagnostic::new(Code::Syntax, span, message).label("there is one above"));
        }
    }

    /// `state NAME when … on … at most … at least …`
    fn state(&mut self) -> Parse<State> {
        let start = self.cursor.position();
        self.cursor.bump(Role::Keyword);
        self.clauses = &["when", "on", "at"];
        let name = self.ident("the state's name")?;
        let span = self.cursor.span_since(start);
        let mut state = State { name, when: None, on: None, at_most: None, at_least: None, span };
        while self.state_clause(&mut state)? {}
        state.span = self.cursor.span_since(start);
        Ok(state)
    }

    /// One more clause of a state; false where there is none.
    fn state_clause(&mut self, state: &mut State) -> Parse<bool> {
        match self.cursor.word() {
            Some("when") if state.when.is_none() => state.when = Some(self.when()?),
            Some("on") if state.on.is_none() => state.on = Some(self.on()?),
            Some("at") => self.stay_bound(state)?,
            _ => return Ok(false),
        }
        Ok(true)
    }

    /// `at most 5 s`, `at least 200 ms`
    fn stay_bound(&mut self, state: &mut State) -> Parse<()> {
        self.word("at")?;
        let bound = match self.cursor.word() {
            Some("most") if state.at_most.is_none() => &mut state.at_most,
            Some("least") if state.at_least.is_none() => &mut state.at_least,
            _ => return self.expected("`most` or `least`, once each"),
        };
        self.cursor.bump(Role::Keyword);
        *bound = Some(self.duration()?);
        Ok(())
    }

    /// `when CONDITION`
    fn when(&mut self) -> Parse<crate::ast::Expr> {
        self.word("when")?;
        Ok(*self.formula()?)
    }

    /// `on EVENT`
    fn on(&mut self) -> Parse<Ident> {
        self.word("on")?;
        self.ident("the name of an event")
    }

    /// `a -> b | c on EVENT when CONDITION`: an edge to each.
    fn edges(&mut self, machine: &mut Machine) -> Parse<()> {
        self.clauses = &["on", "when"];
        let from = self.ident("the name of a state")?;
        self.token(TokenKind::Arrow, "`->`")?;
        let mut targets = vec![self.ident("the name of a state")?];
        while self.eat(TokenKind::Bar) {
            targets.push(self.ident("the name of a state")?);
        }
        let (on, when) = self.edge_clauses()?;
        let edge = |to| Edge { from: from.clone(), to, on: on.clone(), when: when.clone() };
        machine.edges.extend(targets.into_iter().map(edge));
        Ok(())
    }

    fn edge_clauses(&mut self) -> Parse<(Option<Ident>, Option<crate::ast::Expr>)> {
        let (mut on, mut when) = (None, None);
        loop {
            match self.cursor.word() {
                Some("on") if on.is_none() => on = Some(self.on()?),
                Some("when") if when.is_none() => when = Some(self.when()?),
                _ => return Ok((on, when)),
            }
        }
    }
}
