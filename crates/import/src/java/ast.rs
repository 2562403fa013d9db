//! A file of JavaMOP as it is written: monitors with their events, formulas and handlers. Java in it is tokens that nobody has read.

use std::ops::Range;

use super::cursor::{Cursor, Name};

/// `Init(Kicker MK) { … }`
pub(crate) struct Spec<'t> {
    /// The words before its name: `suffix`, `perthread` and their like.
    pub modifiers: Vec<Name>,
    pub name: Name,
    pub parameters: Vec<Parameter>,
    pub events: Vec<Event<'t>>,
    pub blocks: Vec<Block<'t>>,
    /// Fields and methods of the monitor.
    pub members: Vec<Range<usize>>,
}

/// `Kicker MK`
#[derive(Clone, Debug)]
pub(crate) struct Parameter {
    pub class: String,
    pub name: Name,
}

/// Whether an event is before or after its join point.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Side {
    Before,
    After,
}

/// `event ready after(Kicker MK) returning(boolean res): … { … }`
pub(crate) struct Event<'t> {
    pub name: Name,
    /// Whether it is a `creation event`: a monitor begins with one of these, and sees nothing before.
    pub creates: bool,
    pub side: Side,
    pub parameters: Vec<Parameter>,
    pub returning: Option<Parameter>,
    pub throwing: Option<Range<usize>>,
    pub pointcut: Pointcut<'t>,
    pub place: Range<usize>,
    /// What it does besides being an event.
    pub advice: Cursor<'t>,
}

/// Which join points are meant.
#[derive(Clone)]
pub(crate) enum Pointcut<'t> {
    And(Vec<Pointcut<'t>>),
    Or(Vec<Pointcut<'t>>),
    Not(Box<Pointcut<'t>>),
    /// `call(…)`, `target(MK)` and their like.
    Atom(Atom<'t>),
    /// None is given.
    Nothing,
}

/// One of AspectJ's pointcuts, with what stands in its brackets.
#[derive(Clone, Copy)]
pub(crate) struct Atom<'t> {
    pub word: &'t str,
    pub inside: Cursor<'t>,
    pub start: usize,
    pub end: usize,
}

impl Atom<'_> {
    pub(crate) fn place(&self) -> Range<usize> {
        self.start..self.end
    }
}

/// `ltl: … @violation { … }`
pub(crate) struct Block<'t> {
    pub formalism: Name,
    pub formula: Cursor<'t>,
    pub handlers: Vec<Handler<'t>>,
}

/// `@violation { … }`
pub(crate) struct Handler<'t> {
    pub name: Name,
    pub body: Cursor<'t>,
}
