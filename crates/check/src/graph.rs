//! Which statement uses which: it tells what is never used, what is a property of its own, what is defined by itself, and in which
//! order state diagrams move.

use std::collections::BTreeSet;

use lapwing_diag::{Code, Diagnostic};
use lapwing_syntax::ast::{self, EachSet, ExprKind, ItemKind};

use crate::names::{Names, declared};
use crate::walk;

/// The uses among the statements of [`Names::items`].
pub(crate) struct Graph {
    /// For each statement those that it names, in order.
    uses: Vec<BTreeSet<usize>>,
    /// Whether each says something about time, itself or through what it names.
    temporal: Vec<bool>,
    /// Those that are defined by themselves.
    cyclic: BTreeSet<usize>,
}

impl Graph {
    /// Reads all statements. Definitions in terms of themselves are reported.
    pub fn new(names: &Names, diagnostics: &mut Vec<Diagnostic>) -> Graph {
        let uses: Vec<BTreeSet<usize>> = (0..names.items.len()).map(|i| uses_of(names, i)).collect();
        let own: Vec<bool> = names.items.iter().map(|e| exprs(&e.item.kind).into_iter().any(has_time)).collect();
        let mut graph = Graph { uses, temporal: own, cyclic: BTreeSet::new() };
        graph.find_cycles(names, diagnostics);
        graph.spread_time(names);
        graph
    }

    /// Whether a statement says something about time.
    pub fn is_temporal(&self, item: usize) -> bool {
        self.temporal[item]
    }

    /// Whether it is defined by itself.
    pub fn is_cyclic(&self, item: usize) -> bool {
        self.cyclic.contains(&item)
    }

    /// Those that name it, itself not counted.
    pub fn users(&self, item: usize) -> impl Iterator<Item = usize> + '_ {
        (0..self.uses.len()).filter(move |&u| u != item && self.uses[u].contains(&item))
    }

    /// All that a statement names, directly or through others.
    pub fn reach(&self, item: usize) -> BTreeSet<usize> {
        let mut seen = BTreeSet::new();
        let mut open: Vec<usize> = self.uses[item].iter().copied().collect();
        while let Some(next) = open.pop() {
            if seen.insert(next) {
                open.extend(&self.uses[next]);
            }
        }
        seen
    }

    fn find_cycles(&mut self, names: &Names, diagnostics: &mut Vec<Diagnostic>) {
        for item in self.not_well_founded() {
            if !self.reach(item).contains(&item) {
                continue;
            }
            let reported = self.cyclic.iter().any(|&c| self.reach(c).contains(&item) && self.reach(item).contains(&c));
            self.cyclic.insert(item);
            if !reported {
                diagnostics.push(self.recursion(names, item));
            }
        }
    }

    /// What remains when all that rests on nothing, or on what has been taken away, is taken away: circles, and what rests on them.
    fn not_well_founded(&self) -> Vec<usize> {
        let mut open: Vec<usize> = self.uses.iter().map(BTreeSet::len).collect();
        let users = self.reversed();
        let mut ready: Vec<usize> = (0..open.len()).filter(|&i| open[i] == 0).collect();
        while let Some(item) = ready.pop() {
            for &user in &users[item] {
                open[user] -= 1;
                if open[user] == 0 {
                    ready.push(user);
                }
            }
        }
        (0..open.len()).filter(|&i| open[i] > 0).collect()
    }

    /// For each statement those that name it.
    fn reversed(&self) -> Vec<Vec<usize>> {
        let mut users = vec![Vec::new(); self.uses.len()];
        for (user, uses) in self.uses.iter().enumerate() {
            uses.iter().for_each(|&used| users[used].push(user));
        }
        users
    }

    fn recursion(&self, names: &Names, item: usize) -> Diagnostic {
        let name = |i: usize| declared(&names.items[i].item.kind);
        let span = name(item).map_or(names.items[item].item.span, |n| n.span);
        let title = name(item).map_or("this", |n| n.name.as_str());
        let what = match names.items[item].item.kind {
            ItemKind::Machine(_) => "the machine's conditions read its own state",
            _ => "it is defined by itself",
        };
        let mut diagnostic =
            Diagnostic::new(Code::RecursiveName, span, format!("`{title}` depends on itself")).label(what);
        let round = self.reach(item).into_iter().filter(|&i| i != item && self.reach(i).contains(&item));
        for other in round.filter_map(name) {
            diagnostic = diagnostic.also(other.span, format!("through `{}`", other.name));
        }
        let is_formula = matches!(names.items[item].item.kind, ItemKind::Definition(_) | ItemKind::Property(_));
        if is_formula {
            diagnostic = diagnostic.help(format!(
                "where `{title}` was meant as a column or a signal, define this under another name, such as `my_{title}`: \
                 a name that is defined here always means its definition"
            ));
        }
        if is_formula && self.uses[item].contains(&item) {
            return diagnostic
                .help("where it was meant as what was before: that is said by `previously`, `since` or `@{x, -1}`");
        }
        diagnostic.help("write out one of them without the other; what was true before is said by `previously`, `since` or `@{x, -1}`")
    }

    /// A formula that names something temporal is temporal.
    fn spread_time(&mut self, names: &Names) {
        let formula = |i: usize| {
            matches!(names.items[i].item.kind, ItemKind::Definition(_) | ItemKind::Property(_) | ItemKind::Pattern(_))
        };
        let users = self.reversed();
        let mut open: Vec<usize> = (0..self.temporal.len()).filter(|&i| self.temporal[i] && formula(i)).collect();
        while let Some(item) = open.pop() {
            for &user in users[item].iter().filter(|&&u| formula(u)) {
                if !std::mem::replace(&mut self.temporal[user], true) {
                    open.push(user);
                }
            }
        }
    }
}

fn has_time(expr: &ast::Expr) -> bool {
    let mut found = false;
    walk::every(expr, |e| found |= walk::is_temporal(e));
    found
}

/// The expressions of a statement.
pub(crate) fn exprs(kind: &ItemKind) -> Vec<&ast::Expr> {
    match kind {
        ItemKind::Decl(d) => d.default.iter().collect(),
        ItemKind::Event(e) => e.when.iter().collect(),
        ItemKind::Pattern(p) => vec![&p.body],
        ItemKind::Property(p) => vec![&p.body],
        ItemKind::Definition(d) => vec![&d.body],
        ItemKind::Reaction(r) => r.actions.iter().filter_map(written).flat_map(values).collect(),
        ItemKind::Guard(g) => g.instead.iter().flat_map(|(_, message)| values(message)).collect(),
        ItemKind::Machine(m) => {
            let states = m.states.iter().filter_map(|s| s.when.as_ref());
            m.sample.iter().chain(states).chain(m.edges.iter().filter_map(|e| e.when.as_ref())).collect()
        }
        _ => Vec::new(),
    }
}

/// The message that an action sends.
fn written(action: &ast::Action) -> Option<&ast::Literal> {
    match action {
        ast::Action::Publish(_, _, message) | ast::Action::Call(_, _, message) => Some(message),
        _ => None,
    }
}

/// The single values of a message.
fn values(message: &ast::Literal) -> Vec<&ast::Expr> {
    match message {
        ast::Literal::Value(expr) => vec![expr],
        ast::Literal::List(list, _) => list.iter().flat_map(values).collect(),
        ast::Literal::Record(fields, _) => fields.iter().flat_map(|(_, value)| values(value)).collect(),
    }
}

/// The numbers of the statements that one names.
fn uses_of(names: &Names, item: usize) -> BTreeSet<usize> {
    let kind = &names.items[item].item.kind;
    let (shadowed, lists) = (variables(kind), lists(kind));
    let mut mentions = Mentions { names, found: BTreeSet::new(), shadowed, lists };
    for expr in exprs(kind) {
        mentions.read(expr);
    }
    for name in beside(kind) {
        mentions.value(name);
    }
    mentions.found
}

/// The `for each` of a statement.
pub(crate) fn quantifiers(kind: &ItemKind) -> &[ast::ForEach] {
    match kind {
        ItemKind::Property(p) => &p.each,
        ItemKind::Definition(d) => &d.each,
        _ => &[],
    }
}

/// The names of a statement that are its own: parameters and the variables of `for each`.
fn variables(kind: &ItemKind) -> Vec<&str> {
    match kind {
        ItemKind::Pattern(p) => p.params.iter().map(|p| p.name.as_str()).collect(),
        kind => quantifiers(kind).iter().map(|e| e.var.name.as_str()).collect(),
    }
}

/// The variables of `for each r in (a, b)`, with the names that stand for them.
fn lists(kind: &ItemKind) -> Vec<(&str, &[ast::Ident])> {
    let lists = quantifiers(kind).iter().filter_map(|each| match &each.set {
        EachSet::List(values) => Some((each.var.name.as_str(), values.as_slice())),
        _ => None,
    });
    lists.collect()
}

/// The names that stand beside the expressions of a statement. The property that a reaction or guard
/// waits for does not count: they do not use its formula.
fn beside(kind: &ItemKind) -> Vec<&str> {
    let sliced = quantifiers(kind).iter().filter_map(|e| match &e.set {
        EachSet::Values(event, _) => Some(event),
        _ => None,
    });
    let idents: Vec<&ast::Ident> = match kind {
        ItemKind::Decl(d) => d.stale.iter().filter_map(duration_name).collect(),
        ItemKind::Property(p) => p.over.iter().flatten().flat_map(heads).chain(sliced).collect(),
        ItemKind::Definition(_) => sliced.collect(),
        ItemKind::Machine(m) => {
            let bounds = m.states.iter().flat_map(|s| s.at_most.iter().chain(&s.at_least)).filter_map(duration_name);
            let states = m.states.iter().filter_map(|s| s.on.as_ref());
            bounds.chain(states).chain(m.edges.iter().filter_map(|e| e.on.as_ref())).collect()
        }
        _ => Vec::new(),
    };
    idents.into_iter().map(|i| i.name.as_str()).collect()
}

/// The names with which an event of an alphabet begins: its own, or that of the state diagram.
fn heads(event: &ast::Expr) -> Vec<&ast::Ident> {
    match &event.kind {
        ast::ExprKind::Path(names) => names.first().into_iter().collect(),
        ast::ExprKind::Call(_, arguments) => arguments.iter().flat_map(heads).collect(),
        _ => Vec::new(),
    }
}

fn duration_name(dur: &ast::Dur) -> Option<&ast::Ident> {
    match dur {
        ast::Dur::Name(name) => Some(name),
        ast::Dur::Literal(..) => None,
    }
}

/// Collects what expressions name.
struct Mentions<'a, 'n> {
    names: &'n Names<'a>,
    found: BTreeSet<usize>,
    shadowed: Vec<&'n str>,
    lists: Vec<(&'n str, &'n [ast::Ident])>,
}

impl<'n> Mentions<'_, 'n> {
    fn value(&mut self, name: &str) {
        match self.shadowed.iter().filter(|shadowed| **shadowed == name).count() {
            0 => self.found.extend(self.names.values.get(name)),
            // No variable of `any` or `all` stands between it and its `for each`.
            1 => {
                let list = self.lists.iter().filter(|(var, _)| *var == name).flat_map(|(_, values)| *values);
                self.found.extend(list.filter_map(|value| self.names.values.get(value.name.as_str())));
            }
            _ => {}
        }
    }

    fn read(&mut self, expr: &'n ast::Expr) {
        for name in walk::duration_names(expr) {
            self.value(&name.name);
        }
        match &expr.kind {
            ExprKind::Path(idents) => idents.first().into_iter().for_each(|head| self.value(&head.name)),
            ExprKind::Lambda(var, body) => {
                self.shadowed.push(&var.name);
                self.read(body);
                self.shadowed.pop();
            }
            // In `m == s` the right side is a state, whatever else has that name.
            ExprKind::Binary(_, left, _) if self.is_machine(left) => self.read(left),
            kind => {
                if let ExprKind::Call(name, _) = kind {
                    self.found.extend(self.names.patterns.get(name.name.as_str()));
                }
                expr.children().into_iter().for_each(|e| self.read(e));
            }
        }
    }

    fn is_machine(&self, expr: &ast::Expr) -> bool {
        matches!(&expr.kind, ExprKind::Path(p) if p.len() == 1 && self.names.machine(&p[0].name).is_some())
    }
}
