//! What kind of value each signal has: what its declaration says, and else what is done with it.

use std::collections::{BTreeMap, BTreeSet};

use lapwing_check::checked::Spec;
use lapwing_engine::program::{Func, Node, NodeId, Op, Positions, Program};
use lapwing_stream::{Type, Value};

use crate::interface::{From, Kind};

/// The kinds of the values that come from outside.
#[derive(Clone, Debug, Default)]
pub(crate) struct Kinds {
    known: BTreeMap<From, Kind>,
    /// Those that are only ever taken for true or false.
    conditions: BTreeSet<From>,
    /// Of which two kinds are wanted.
    pub clashes: Vec<From>,
}

impl Kinds {
    /// Works them out for everything in a program.
    pub fn of(spec: &Spec, program: &Program) -> Kinds {
        let mut kinds = Kinds::default();
        for (i, input) in spec.inputs.iter().enumerate() {
            let default = input.default.as_ref().and_then(of_value);
            if let Some(kind) = of_type(&input.ty).or(default) {
                kinds.known.insert(From::Input(i), kind);
            }
        }
        for (e, event) in spec.events.iter().enumerate() {
            for (f, field) in event.fields.iter().enumerate() {
                if let Some(kind) = of_type(&field.ty) {
                    kinds.known.insert(From::EventField(e, f), kind);
                }
            }
        }
        // What one comparison shows of a signal may show another's kind, and so on.
        for _ in 0..=spec.inputs.len().min(16) {
            let before = kinds.known.len();
            each_positions(program, |at| kinds.learn(at));
            if kinds.known.len() == before {
                break;
            }
        }
        kinds
    }

    /// The kind of a value from outside.
    pub fn get(&self, from: From) -> Kind {
        let is_condition = self.conditions.contains(&from);
        self.known.get(&from).copied().unwrap_or(if is_condition { Kind::Truth } else { Kind::Number })
    }

    fn learn(&mut self, at: &Positions) {
        for op in &at.ops {
            match op {
                Op::Slot { slot, truth: true } => drop(self.conditions.insert(From::Input(*slot))),
                Op::Slot { slot, truth: false } => self.set(From::Input(*slot), Kind::Truth),
                Op::Holds(node) => self.want(at, *node, Kind::Truth),
                Op::Delta(node) | Op::Rate(node) | Op::Window(_, node, _) => self.want(at, *node, Kind::Number),
                _ => {}
            }
        }
        for node in &at.nodes {
            self.node(at, node);
        }
    }

    fn node(&mut self, at: &Positions, node: &Node) {
        let numbers = |kinds: &mut Kinds, of: &[NodeId]| of.iter().for_each(|&n| kinds.want(at, n, Kind::Number));
        match node {
            Node::Neg(a) => numbers(self, &[*a]),
            Node::Arith(_, a, b) => numbers(self, &[*a, *b]),
            Node::Compare { margin, left, right, .. } => {
                numbers(self, &[*left, *right]);
                margin.iter().for_each(|m| numbers(self, &[*m]));
            }
            Node::CompareAny { left, right, .. } => match (self.of_node(at, *left), self.of_node(at, *right)) {
                (Some(kind), None) => self.want(at, *right, kind),
                (None, Some(kind)) => self.want(at, *left, kind),
                _ => {}
            },
            Node::Call(_, args) => numbers(self, args),
            Node::Not(a) => self.want(at, *a, Kind::Truth),
            Node::And(a, b) | Node::Or(a, b) | Node::Iff(a, b) => {
                [a, b].into_iter().for_each(|&n| self.want(at, n, Kind::Truth));
            }
            Node::Truth(of) => {
                if let Some(from) = source(at, *of) {
                    self.conditions.insert(from);
                }
            }
            _ => {}
        }
    }

    fn want(&mut self, at: &Positions, node: NodeId, kind: Kind) {
        if let Some(from) = source(at, node) {
            self.set(from, kind);
        }
    }

    fn set(&mut self, from: From, kind: Kind) {
        match self.known.insert(from, kind) {
            Some(before) if before != kind => {
                self.known.insert(from, before);
                if !self.clashes.contains(&from) {
                    self.clashes.push(from);
                }
            }
            _ => {}
        }
    }

    /// The kind of an expression's value, once all is known that can be.
    pub fn settled(&self, at: &Positions, node: NodeId) -> Kind {
        self.of_node(at, node).or(source(at, node).map(|from| self.get(from))).unwrap_or(Kind::Number)
    }

    /// The kind of an expression's value, as far as it is known.
    pub fn of_node(&self, at: &Positions, node: NodeId) -> Option<Kind> {
        match &at.nodes[node as usize] {
            Node::Num(_) | Node::Neg(_) | Node::Arith(..) | Node::Age(_) | Node::Frequency(..) => Some(Kind::Number),
            Node::Str(_) => Some(Kind::Text),
            Node::Call(func, _) => Some(if *func == Func::IsNan { Kind::Truth } else { Kind::Number }),
            Node::Reg(register) => match at.ops.get(*register as usize) {
                Some(Op::Lookback(of, _)) => self.of_node(at, *of),
                _ => Some(Kind::Number),
            },
            Node::Slot(slot) => self.known.get(&From::Input(*slot)).copied(),
            Node::EventField { event, field } => self.known.get(&From::EventField(*event, *field)).copied(),
            _ => Some(Kind::Truth),
        }
    }
}

/// The value from outside that an expression is, now or a few instants ago.
fn source(at: &Positions, node: NodeId) -> Option<From> {
    match at.nodes.get(node as usize)? {
        Node::Slot(slot) => Some(From::Input(*slot)),
        Node::EventField { event, field } => Some(From::EventField(*event, *field)),
        Node::Reg(register) => match at.ops.get(*register as usize)? {
            Op::Lookback(of, _) => source(at, *of),
            _ => None,
        },
        _ => None,
    }
}

/// All expressions of a program.
pub(crate) fn each_positions(program: &Program, mut see: impl FnMut(&Positions)) {
    program.groups.iter().for_each(|g| see(&g.at));
    program.machines.iter().for_each(|m| see(&m.at));
    program.events.iter().filter_map(|e| e.when.as_ref()).for_each(|(at, _)| see(at));
}

fn of_type(ty: &Type) -> Option<Kind> {
    match ty {
        Type::Bool => Some(Kind::Truth),
        Type::Num { .. } => Some(Kind::Number),
        Type::Str => Some(Kind::Text),
        Type::Array(_) | Type::Message(_) | Type::Any => None,
    }
}

fn of_value(value: &Value) -> Option<Kind> {
    match value {
        Value::Bool(_) => Some(Kind::Truth),
        Value::Num(_) => Some(Kind::Number),
        Value::Str(_) => Some(Kind::Text),
        _ => None,
    }
}
