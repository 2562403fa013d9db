//! A formula as text with holes, which prints and shrinks without knowing the language.

use std::fmt;

/// What may stand in a hole.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Sort {
    /// A condition without future operators.
    State,
    /// Any formula.
    Formula,
    /// A number.
    Number,
    /// Part of an `ltl(…)`.
    Ltl,
}

/// A text with holes for other terms.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Term {
    /// What it is.
    pub sort: Sort,
    /// The text, each `#` a hole.
    pub text: String,
    /// What fills the holes.
    pub parts: Vec<Term>,
}

impl Term {
    /// A term without holes.
    pub fn atom(sort: Sort, text: impl Into<String>) -> Term {
        Term { sort, text: text.into(), parts: Vec::new() }
    }

    /// A term with holes.
    pub fn node(sort: Sort, text: impl Into<String>, parts: Vec<Term>) -> Term {
        Term { sort, text: text.into(), parts }
    }

    /// Whether it may stand where a term of this sort does.
    fn fits(&self, sort: Sort) -> bool {
        self.sort == sort || (self.sort == Sort::State && sort == Sort::Formula)
    }

    /// All terms that are smaller by one step: a part in place of the whole, here or further down.
    pub fn smaller(&self) -> Vec<Term> {
        let mut all: Vec<Term> = self.parts.iter().filter(|p| p.fits(self.sort)).cloned().collect();
        for (n, part) in self.parts.iter().enumerate() {
            for less in part.smaller() {
                let mut copy = self.clone();
                copy.parts[n] = less;
                all.push(copy);
            }
        }
        all
    }
}

impl fmt::Display for Term {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut parts = self.parts.iter();
        for (n, piece) in self.text.split('#').enumerate() {
            if n > 0
                && let Some(part) = parts.next()
            {
                write!(f, "{part}")?;
            }
            f.write_str(piece)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn holes_are_filled_in_order_and_parts_are_smaller() {
        let atom = |t: &str| Term::atom(Sort::State, t);
        let both = Term::node(Sort::State, "(# and #)", vec![atom("a"), atom("b")]);
        let term = Term::node(Sort::Formula, "(always #)", vec![both]);
        assert_eq!(term.to_string(), "(always (a and b))");
        let smaller: Vec<String> = term.smaller().iter().map(Term::to_string).collect();
        assert_eq!(smaller, ["(a and b)", "(always a)", "(always b)"]);
    }
}
