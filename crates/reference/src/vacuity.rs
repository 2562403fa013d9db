//! How often each scope and each `whenever` of a property was entered (language reference, *Verdicts*: vacuity).
//!
//! A scope is entered at a position only if *Temporal operators* looks at it there, whether or not all is decided by then. Each
//! position at which something is entered counts once.

use crate::course::Course;
use crate::future::{End, View};
use crate::truth::Truth;
use lapwing_check::checked::{Expr, Kind, Scope};
use std::collections::BTreeSet;

/// The number of entries of each scope and `whenever`, in the order in which they are written.
pub(crate) fn entries(course: &Course<'_>, formula: &Expr) -> Vec<usize> {
    let mut nodes = Vec::new();
    scopes(formula, &mut nodes);
    let mut look = Look { course, entered: vec![BTreeSet::new(); nodes.len()], nodes, seen: BTreeSet::new() };
    if course.len() > 0 {
        look.at(formula, 0, course.whole());
    }
    look.entered.iter().map(BTreeSet::len).collect()
}

/// The number of scopes of a formula.
pub(crate) fn count(formula: &Expr) -> usize {
    let mut nodes = Vec::new();
    scopes(formula, &mut nodes);
    nodes.len()
}

/// The scopes of a formula, each before those inside it.
fn scopes<'e>(f: &'e Expr, found: &mut Vec<&'e Expr>) {
    if matches!(f.kind, Kind::Scope(..) | Kind::AfterUntil(..)) {
        found.push(f);
    }
    for child in f.children() {
        scopes(child, found);
    }
}

struct Look<'c, 'e> {
    course: &'c Course<'c>,
    nodes: Vec<&'e Expr>,
    /// The positions at which each was entered.
    entered: Vec<BTreeSet<usize>>,
    /// What has been looked at: expression, position and the end of the segment.
    seen: BTreeSet<(*const Expr, usize, usize)>,
}

impl<'e> Look<'_, 'e> {
    /// A formula at position `k` of a segment. Without future operators there is no scope in it, with a hat or without.
    fn at(&mut self, f: &'e Expr, k: usize, view: View) {
        if !f.has_future() || !self.seen.insert((std::ptr::from_ref(f), k, view.upto())) {
            return;
        }
        let upto = view.upto();
        let course = self.course;
        let distance = |j: usize| course.time(j).since(course.time(k));
        match &f.kind {
            Kind::Always(bound, body) | Kind::Eventually(bound, body) => {
                for j in (k..upto).filter(|&j| bound.contains(distance(j))) {
                    self.at(body, j, view);
                }
            }
            Kind::Next(body) => {
                if k + 1 < upto {
                    self.at(body, k + 1, view);
                }
            }
            Kind::Until(bound, left, right) => {
                let candidates: Vec<usize> = (k..upto).filter(|&j| bound.contains(distance(j))).collect();
                for &j in &candidates {
                    self.at(right, j, view);
                }
                for j in k..candidates.last().copied().unwrap_or(k) {
                    self.at(left, j, view);
                }
            }
            Kind::Scope(Scope::After, x, body) => {
                if let Some(j) = self.first(x, k, view) {
                    self.enter(f, j);
                    self.at(body, j, view);
                }
            }
            Kind::Scope(Scope::Until | Scope::Before, x, body) => {
                if let Some(j) = self.first(x, k, view) {
                    self.enter(f, j);
                    self.segment(body, k, Some(j), view);
                }
            }
            Kind::Scope(Scope::While, x, body) => self.runs(f, x, body, k, view),
            Kind::Scope(Scope::Whenever, x, body) => {
                for j in k..upto {
                    self.at(x, j, view);
                    if course.truth(x, j, view) == Truth::True {
                        self.enter(f, j);
                        self.at(body, j, view);
                    }
                }
            }
            Kind::AfterUntil(x, y, body) => self.stretches(f, x, y, body, k, view),
            // Operands of connectives are looked at where the connective is.
            _ => f.children().into_iter().for_each(|child| self.at(child, k, view)),
        }
    }

    fn runs(&mut self, f: &'e Expr, x: &'e Expr, body: &'e Expr, k: usize, view: View) {
        let mut from = k;
        while let Some(i) = self.first(x, from, view) {
            let holds = |j: usize| self.course.truth(x, j, view) == Truth::True;
            let end = (i..view.upto()).find(|&j| !holds(j));
            (i..end.unwrap_or(i)).for_each(|j| self.at(x, j, view));
            self.enter(f, i);
            self.segment(body, i, end, view);
            match end {
                Some(end) => from = end,
                None => return,
            }
        }
    }

    fn stretches(&mut self, f: &'e Expr, x: &'e Expr, y: &'e Expr, body: &'e Expr, k: usize, view: View) {
        let mut from = k;
        while let Some(i) = self.first(x, from, view) {
            let end = self.first(y, i, view);
            self.enter(f, i);
            self.segment(body, i, end, view);
            match end {
                Some(end) => from = end + 1,
                None => return,
            }
        }
    }

    /// A scope's body in the segment from `i` to `end`, where that is known; nothing looks into an empty one.
    fn segment(&mut self, body: &'e Expr, i: usize, end: Option<usize>, view: View) {
        let view = end.map_or(view, |end| View { end: End::At(end), ..view });
        if i < view.upto() {
            self.at(body, i, view);
        }
    }

    fn enter(&mut self, scope: &'e Expr, at: usize) {
        if let Some(node) = self.nodes.iter().position(|&n| std::ptr::eq(n, scope)) {
            self.entered[node].insert(at);
        }
    }

    /// The first position with X; those up to it are looked at. What stays unknown ends the search.
    fn first(&mut self, x: &'e Expr, from: usize, view: View) -> Option<usize> {
        for j in from..view.upto() {
            self.at(x, j, view);
            match self.course.truth(x, j, view) {
                Truth::True => return Some(j),
                Truth::False => {}
                Truth::Unknown => return None,
            }
        }
        None
    }
}
