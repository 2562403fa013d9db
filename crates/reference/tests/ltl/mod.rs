//! Linear temporal logic as the literature writes it, on traces that end: no more than the formulas of the libraries need.

/// A formula.
#[derive(Clone, Debug)]
pub enum Ltl {
    Prop(usize),
    /// `a'`: true now and not at the instant before.
    Entered(usize),
    Not(Box<Ltl>),
    And(Box<Ltl>, Box<Ltl>),
    Or(Box<Ltl>, Box<Ltl>),
    Implies(Box<Ltl>, Box<Ltl>),
    Iff(Box<Ltl>, Box<Ltl>),
    Next(Box<Ltl>),
    /// `<> within d f`, `<> f`
    Eventually(Option<i64>, Box<Ltl>),
    Always(Option<i64>, Box<Ltl>),
    Until(Box<Ltl>, Box<Ltl>),
    WeakUntil(Box<Ltl>, Box<Ltl>),
}

/// An instant: its time in seconds, and what is true.
pub struct Row {
    pub time: i64,
    pub props: Vec<bool>,
}

impl Ltl {
    /// Reads a formula over these propositions; `within` in it is a bound of that many seconds.
    pub fn parse(text: &str, props: &[&str], within: i64) -> Ltl {
        let symbols = ["(", ")", "!", "[]", "<>", "&&", "||"];
        let spaced = symbols.iter().fold(text.to_owned(), |text, symbol| text.replace(symbol, &format!(" {symbol} ")));
        let tokens: Vec<&str> = spaced.split_whitespace().collect();
        let mut parser = Parser { tokens: &tokens, at: 0, props, within };
        let formula = parser.iff();
        assert_eq!(parser.at, tokens.len(), "{text}: {:?} is left", &tokens[parser.at..]);
        formula
    }

    /// Whether it holds at an instant of a trace.
    pub fn holds(&self, rows: &[Row], k: usize) -> bool {
        let within = |bound: &Option<i64>, j: usize| bound.is_none_or(|d| rows[j].time - rows[k].time <= d);
        match self {
            Ltl::Prop(p) => rows[k].props[*p],
            Ltl::Entered(p) => rows[k].props[*p] && (k == 0 || !rows[k - 1].props[*p]),
            Ltl::Not(a) => !a.holds(rows, k),
            Ltl::And(a, b) => a.holds(rows, k) && b.holds(rows, k),
            Ltl::Or(a, b) => a.holds(rows, k) || b.holds(rows, k),
            Ltl::Implies(a, b) => !a.holds(rows, k) || b.holds(rows, k),
            Ltl::Iff(a, b) => a.holds(rows, k) == b.holds(rows, k),
            Ltl::Next(a) => k + 1 < rows.len() && a.holds(rows, k + 1),
            Ltl::Eventually(bound, a) => (k..rows.len()).any(|j| within(bound, j) && a.holds(rows, j)),
            Ltl::Always(bound, a) => (k..rows.len()).all(|j| !within(bound, j) || a.holds(rows, j)),
            Ltl::Until(a, b) => until(a, b, rows, k),
            Ltl::WeakUntil(a, b) => until(a, b, rows, k) || (k..rows.len()).all(|j| a.holds(rows, j)),
        }
    }
}

fn until(a: &Ltl, b: &Ltl, rows: &[Row], k: usize) -> bool {
    let first = (k..rows.len()).find(|&j| b.holds(rows, j));
    first.is_some_and(|first| (k..first).all(|j| a.holds(rows, j)))
}

struct Parser<'t> {
    tokens: &'t [&'t str],
    at: usize,
    props: &'t [&'t str],
    within: i64,
}

impl Parser<'_> {
    fn eat(&mut self, any: &[&str]) -> bool {
        let here = self.tokens.get(self.at).is_some_and(|t| any.contains(t));
        self.at += usize::from(here);
        here
    }

    fn iff(&mut self) -> Ltl {
        let mut left = self.implies();
        while self.eat(&["<=>"]) {
            left = Ltl::Iff(Box::new(left), Box::new(self.implies()));
        }
        left
    }

    fn implies(&mut self) -> Ltl {
        let left = self.or();
        match self.eat(&["=>"]) {
            true => Ltl::Implies(Box::new(left), Box::new(self.implies())),
            false => left,
        }
    }

    fn or(&mut self) -> Ltl {
        let mut left = self.and();
        while self.eat(&["||"]) {
            left = Ltl::Or(Box::new(left), Box::new(self.and()));
        }
        left
    }

    fn and(&mut self) -> Ltl {
        let mut left = self.until();
        while self.eat(&["&&", "and"]) {
            left = Ltl::And(Box::new(left), Box::new(self.until()));
        }
        left
    }

    fn until(&mut self) -> Ltl {
        let left = self.unary();
        if self.eat(&["U"]) {
            return Ltl::Until(Box::new(left), Box::new(self.until()));
        }
        match self.eat(&["W"]) {
            true => Ltl::WeakUntil(Box::new(left), Box::new(self.until())),
            false => left,
        }
    }

    fn bound(&mut self) -> Option<i64> {
        let bounded = self.eat(&["within"]);
        self.at += usize::from(bounded);
        bounded.then_some(self.within)
    }

    fn unary(&mut self) -> Ltl {
        if self.eat(&["!", "not"]) {
            return Ltl::Not(Box::new(self.unary()));
        }
        if self.eat(&["o"]) {
            return Ltl::Next(Box::new(self.unary()));
        }
        if self.eat(&["<>"]) {
            let bound = self.bound();
            return Ltl::Eventually(bound, Box::new(self.unary()));
        }
        if self.eat(&["[]"]) {
            let bound = self.bound();
            return Ltl::Always(bound, Box::new(self.unary()));
        }
        if self.eat(&["("]) {
            let inner = self.iff();
            assert!(self.eat(&[")"]), "a bracket is open at {:?}", &self.tokens[self.at..]);
            return inner;
        }
        let token = self.tokens[self.at];
        self.at += 1;
        let name = token.trim_end_matches('\'');
        let prop = self.props.iter().position(|p| *p == name).unwrap_or_else(|| panic!("`{token}` is no proposition"));
        if token.ends_with('\'') { Ltl::Entered(prop) } else { Ltl::Prop(prop) }
    }
}
