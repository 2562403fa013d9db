//! Types of atoms.

use super::{Parse, Parser, Reported};
use crate::ast::{
    AtomPort, AtomPriority, AtomType, Clock, Data, EventPolicy, Expr, ExternPort, Initial, Invariant, Name, Path, Port,
    Resume, Stmt, StmtKind, TimeUnit, Transition, Urgency,
};
use crate::lexer::TokenKind;
use lapwing_diag::{Code, Diagnostic};

/// The words that begin a member of an atom.
const STARTS: &[&str] = &[
    "data",
    "export",
    "clock",
    "port",
    "extern",
    "place",
    "places",
    "state",
    "initial",
    "on",
    "internal",
    "invariant",
    "priority",
    "end",
];

impl Parser<'_> {
    pub(super) fn atom_type(&mut self) -> Parse<AtomType> {
        self.require("atom")?;
        self.require("type")?;
        let name = self.name("the name of the type")?;
        let mut atom = AtomType { name, params: self.params()?, ..AtomType::default() };
        let mut has_initial = false;
        while !self.is("end") && !self.at_end() && !self.begins_type() {
            let before = self.at;
            if self.atom_member(&mut atom, &mut has_initial).is_err() {
                if self.at == before {
                    self.advance();
                }
                self.skip_to(STARTS);
            }
        }
        let name = atom.name.clone();
        if !has_initial {
            let message = format!("the atom `{}` does not say where it begins", name.text);
            let help = "add `initial to PLACE` behind its places";
            self.report(Diagnostic::new(Code::Syntax, name.span, message).help(help));
        }
        self.close_type(&name)?;
        Ok(atom)
    }

    /// The `end` of a type.
    pub(super) fn close_type(&mut self, name: &Name) -> Parse<()> {
        if self.take("end") {
            return Ok(());
        }
        let message = format!("`{}` has no `end`", name.text);
        let diagnostic = Diagnostic::new(Code::UnclosedBracket, self.span(), message).also(name.span, "begins here");
        self.report(diagnostic);
        // What has been read of it is kept.
        Ok(())
    }

    fn atom_member(&mut self, atom: &mut AtomType, has_initial: &mut bool) -> Parse<()> {
        // Remarks for compilers may stand in front of members too.
        self.annotations()?;
        match self.peek(0) {
            "data" => atom.data.extend(self.data(false)?),
            "export" if self.is_ahead(1, "data") => {
                self.advance();
                atom.data.extend(self.data(true)?);
            }
            "export" => {
                self.advance();
                atom.ports.extend(self.atom_ports(true)?);
            }
            "port" => atom.ports.extend(self.atom_ports(false)?),
            "extern" => atom.externals.push(self.extern_port()?),
            "clock" => atom.clocks.extend(self.clocks()?),
            "place" | "places" | "state" => {
                self.advance();
                atom.places.extend(self.names("the name of a place")?);
            }
            "initial" => {
                let initial = self.initial()?;
                if std::mem::replace(has_initial, true) {
                    return self.fail(Code::Syntax, initial.span, "an atom begins only once");
                }
                atom.initial = initial;
            }
            "on" | "internal" => atom.transitions.push(self.transition()?),
            "invariant" => atom.invariants.push(self.invariant()?),
            "priority" => atom.priorities.push(self.atom_priority()?),
            found => {
                let near = lapwing_diag::suggest::nearest(found, STARTS.iter().copied());
                let message = format!("a part of an atom is expected here, and `{found}` begins none");
                let diagnostic = Diagnostic::new(Code::Syntax, self.span(), message);
                let diagnostic = match near {
                    Some(near) => diagnostic.help(format!("did you mean `{near}`?")),
                    None => diagnostic,
                };
                return Err(self.report(diagnostic));
            }
        }
        Ok(())
    }

    /// `data int x = 1, y`
    pub(super) fn data(&mut self, is_exported: bool) -> Parse<Vec<Data>> {
        self.require("data")?;
        let ty = self.path("a type")?;
        self.separated(|p| {
            let name = p.name("the name of a variable")?;
            let value = if p.take("=") { Some(p.expr()?) } else { None };
            Ok(Data { notes: Vec::new(), is_exported, ty: ty.clone(), name, value })
        })
    }

    /// `clock x, y unit millisecond`, and the older `clock x unit 1 millisecond`.
    fn clocks(&mut self) -> Parse<Vec<Clock>> {
        self.require("clock")?;
        let names = self.names("the name of a clock")?;
        let unit = if self.take("unit") { self.unit()? } else { TimeUnit::default() };
        Ok(names.into_iter().map(|name| Clock { name, unit }).collect())
    }

    fn unit(&mut self) -> Parse<TimeUnit> {
        if self.kind() == TokenKind::Int {
            if self.peek(0) != "1" {
                return self.missing("a unit, such as `millisecond`, or `1` and a unit");
            }
            self.advance();
        }
        let found = self.here();
        if let Some(unit) = TimeUnit::ALL.into_iter().find(|u| u.word() == found) {
            self.advance();
            return Ok(unit);
        }
        let near = lapwing_diag::suggest::nearest(&found, TimeUnit::ALL.map(TimeUnit::word));
        let diagnostic = Diagnostic::new(Code::UnknownUnit, self.span(), format!("`{found}` is no unit of time"));
        Err(self.report(match near {
            Some(near) => diagnostic.help(format!("did you mean `{near}`?")),
            None => diagnostic.help("units are nanosecond, microsecond, millisecond, second, minute, hour and day"),
        }))
    }

    fn port_decl(&mut self, ty: &Path) -> Parse<Port> {
        let name = self.name("the name of a port")?;
        let args = self.bracketed(|p| p.name("a variable"))?;
        Ok(Port { ty: ty.clone(), name, args })
    }

    /// `port T p(x), q(y)`, `export port T p(x), q(y) as r`
    fn atom_ports(&mut self, is_exported: bool) -> Parse<Vec<AtomPort>> {
        self.require("port")?;
        let ty = self.path("a type of ports")?;
        let ports = self.separated(|p| p.port_decl(&ty))?;
        if self.take("as") {
            let merged = Some(self.name("the name by which the port is seen")?);
            return Ok(vec![AtomPort { notes: Vec::new(), is_exported, ports, merged }]);
        }
        let single = |port| AtomPort { notes: Vec::new(), is_exported, ports: vec![port], merged: None };
        Ok(ports.into_iter().map(single).collect())
    }

    fn extern_port(&mut self) -> Parse<ExternPort> {
        self.require("extern")?;
        self.require("port")?;
        let ty = self.path("a type of ports")?;
        let port = self.port_decl(&ty)?;
        let backend = if self.take("as") { Some(self.text_literal()?) } else { None };
        let policies = [EventPolicy::Remember, EventPolicy::Ignore, EventPolicy::Error];
        let policy = policies.into_iter().find(|policy| self.is(policy.word()));
        if policy.is_some() {
            self.advance();
        }
        Ok(ExternPort { notes: Vec::new(), port, backend, policy: policy.unwrap_or_default() })
    }

    fn initial(&mut self) -> Parse<Initial> {
        let start = self.require("initial")?;
        self.require("to")?;
        let places = self.names("a place")?;
        let body = if self.take("do") { self.block()? } else { Vec::new() };
        let resume = self.resume()?;
        Ok(Initial { places, body, resume, span: start.to(self.last_span()) })
    }

    fn resume(&mut self) -> Parse<Option<Resume>> {
        let start = self.span();
        if !self.take("resume") {
            return Ok(None);
        }
        let guard = if self.is("(") { Some(self.condition()?) } else { None };
        Ok(Some(Resume { guard, span: start.to(self.last_span()) }))
    }

    fn transition(&mut self) -> Parse<Transition> {
        let start = self.span();
        let port = match self.take("internal") {
            true => None,
            false => {
                self.require("on")?;
                let port = self.name("a port")?;
                // The older form has empty brackets behind the port.
                if self.take("(") {
                    self.require(")")?;
                }
                Some(port)
            }
        };
        self.require("from")?;
        let from = self.names("a place")?;
        self.require("to")?;
        let to = self.names("a place")?;
        let mut transition = Transition { port, from, to, ..Transition::default() };
        self.clauses(&mut transition)?;
        transition.span = start.to(self.last_span());
        Ok(transition)
    }

    /// `provided`, the urgency, `do` and `resume`: each at most once, in this order.
    fn clauses(&mut self, transition: &mut Transition) -> Parse<()> {
        let mut reached = 0;
        loop {
            let span = self.span();
            let urgency = [Urgency::Lazy, Urgency::Delayable, Urgency::Eager].into_iter().find(|u| self.is(u.word()));
            let place = if self.is_any(&["provided", "when"]) {
                self.advance();
                transition.guard = Some(self.condition()?);
                1
            } else if urgency.is_some() {
                self.advance();
                transition.urgency = urgency;
                2
            } else if self.take("do") {
                transition.body = self.block()?;
                3
            } else if self.is("reset") {
                transition.body = self.resets()?;
                3
            } else if self.is("resume") {
                transition.resume = self.resume()?;
                4
            } else {
                return Ok(());
            };
            if place <= reached {
                let message = "this clause comes twice, or too late";
                let diagnostic = Diagnostic::new(Code::BipClauseOrder, span, message);
                let help =
                    "a transition says `provided`, then its urgency, then `do`, then `resume`, each at most once";
                self.report(diagnostic.help(help));
            }
            reached = reached.max(place);
        }
    }

    /// The older clause `reset c, d`: these clocks are zero from now on.
    fn resets(&mut self) -> Parse<Vec<Stmt>> {
        self.require("reset")?;
        let clocks = self.names("a clock")?;
        let zero = |clock: Name| {
            let span = clock.span;
            Stmt { kind: StmtKind::Assign(clock.into(), Expr::int(0)), span }
        };
        Ok(clocks.into_iter().map(zero).collect())
    }

    fn invariant(&mut self) -> Parse<Invariant> {
        let start = self.require("invariant")?;
        let name = self.name("the name of the invariant")?;
        let has_places = self.take("at") || self.take("from");
        let places = if has_places { self.names("a place")? } else { Vec::new() };
        self.provided()?;
        let guard = self.condition()?;
        Ok(Invariant { notes: Vec::new(), name, places, guard, span: start.to(self.last_span()) })
    }

    pub(super) fn provided(&mut self) -> Parse<()> {
        if self.take("when") { Ok(()) } else { self.require("provided").map(drop) }
    }

    /// The guard of a rule, if it has one.
    pub(super) fn optional_guard(&mut self) -> Parse<Option<Expr>> {
        if !self.is_any(&["provided", "when"]) {
            return Ok(None);
        }
        self.advance();
        self.condition().map(Some)
    }

    fn atom_priority(&mut self) -> Parse<AtomPriority> {
        let start = self.require("priority")?;
        let name = self.name("the name of the priority")?;
        let side = |p: &mut Self| if p.take("*") { Ok(None) } else { p.name("a port").map(Some) };
        let left = side(self)?;
        let is_less = self.less()?;
        let right = side(self)?;
        let (low, high) = if is_less { (left, right) } else { (right, left) };
        let guard = self.optional_guard()?;
        Ok(AtomPriority { notes: Vec::new(), name, low, high, guard, span: start.to(self.last_span()) })
    }

    /// `<`: true; `>`, as the paper writes: false.
    pub(super) fn less(&mut self) -> Result<bool, Reported> {
        match () {
            () if self.take("<") => Ok(true),
            () if self.take(">") => Ok(false),
            () => self.missing("`<`"),
        }
    }
}
