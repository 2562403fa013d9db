//! W1: the properties of the Timescales benchmark (Ulus, RV 2019), each with the loop that one would write for it by hand.
//!
//! Booleans p, q, r, s at discrete steps; non-strict operators, closed windows cut at step 0; `a` is three tenths of `b`.

/// The columns of a row.
pub const COLUMNS: [&str; 4] = ["p", "q", "r", "s"];
/// One step's values.
pub type Row = [bool; 4];

/// A property of the benchmark.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[allow(missing_docs)]
pub enum Property {
    RecurGlb,
    AbsentAq,
    AlwaysAq,
    AbsentBr,
    AlwaysBr,
    AbsentBqr,
    AlwaysBqr,
    RecurBqr,
    RespondGlb,
    RespondBqr,
}

impl Property {
    /// All of them.
    pub const ALL: [Property; 10] = [
        Property::RecurGlb,
        Property::AbsentAq,
        Property::AlwaysAq,
        Property::AbsentBr,
        Property::AlwaysBr,
        Property::AbsentBqr,
        Property::AlwaysBqr,
        Property::RecurBqr,
        Property::RespondGlb,
        Property::RespondBqr,
    ];

    /// The formula in Lapwing's language, a step being a millisecond.
    pub fn formula(self, b: u32) -> String {
        let a = lower(b);
        let asked = "(r and not q and once q)";
        let response =
            format!("((s implies once within [{a} ms, {b} ms] p) and not (not s since within [{b} ms, 1000 h] p))");
        match self {
            Property::RecurGlb => format!("once within {b} ms p"),
            Property::AbsentAq => format!("(once within {b} ms q) implies (not p since q)"),
            Property::AlwaysAq => format!("(once within {b} ms q) implies (p since q)"),
            Property::AbsentBr => format!("r implies historically within {b} ms not p"),
            Property::AlwaysBr => format!("r implies historically within {b} ms p"),
            Property::AbsentBqr => format!("{asked} implies (not p since within [{a} ms, {b} ms] q)"),
            Property::AlwaysBqr => format!("{asked} implies (p since within [{a} ms, {b} ms] q)"),
            Property::RecurBqr => format!("{asked} implies ((once within {b} ms (p or q)) since q)"),
            Property::RespondGlb => response,
            Property::RespondBqr => format!("{asked} implies ({response} since q)"),
        }
    }

    /// The monitor written by hand: how many steps violate it.
    pub fn by_hand(self, b: u32, rows: &[Row]) -> u64 {
        let (a, b) = (i64::from(lower(b)), i64::from(b));
        let mut bad = 0;
        let mut hand = ByHand { a, b, ..ByHand::default() };
        macro_rules! each {
            ($step:ident) => {
                for (t, row) in rows.iter().enumerate() {
                    bad += u64::from(!hand.$step(t as i64, row));
                }
            };
        }
        match self {
            Property::RecurGlb => each!(recur_glb),
            Property::AbsentAq => each!(absent_aq),
            Property::AlwaysAq => each!(always_aq),
            Property::AbsentBr => each!(absent_br),
            Property::AlwaysBr => each!(always_br),
            Property::AbsentBqr => each!(absent_bqr),
            Property::AlwaysBqr => each!(always_bqr),
            Property::RecurBqr => each!(recur_bqr),
            Property::RespondGlb => each!(respond_glb),
            Property::RespondBqr => each!(respond_bqr),
        }
        bad
    }

    /// One step of the hand-written monitor.
    fn step(self, hand: &mut ByHand, t: i64, row: &Row) -> bool {
        match self {
            Property::RecurGlb => hand.recur_glb(t, row),
            Property::AbsentAq => hand.absent_aq(t, row),
            Property::AlwaysAq => hand.always_aq(t, row),
            Property::AbsentBr => hand.absent_br(t, row),
            Property::AlwaysBr => hand.always_br(t, row),
            Property::AbsentBqr => hand.absent_bqr(t, row),
            Property::AlwaysBqr => hand.always_bqr(t, row),
            Property::RecurBqr => hand.recur_bqr(t, row),
            Property::RespondGlb => hand.respond_glb(t, row),
            Property::RespondBqr => hand.respond_bqr(t, row),
        }
    }

    /// A trace on which it holds everywhere: at each step the first of a few random rows that keeps it true.
    pub fn satisfying(self, b: u32, steps: usize) -> Vec<Row> {
        let mut hand = ByHand { a: i64::from(lower(b)), b: i64::from(b), ..ByHand::default() };
        let mut random = Random(7);
        let rare = 1.0 / f64::from(b.max(2));
        let mut rows = Vec::with_capacity(steps);
        for t in 0..steps {
            // Responses come when the benchmark's generator would place them: regularly, in the middle of their window.
            let phase = t % b as usize;
            let due = phase == (lower(b) + b) as usize / 2;
            let beat = phase == 0;
            let candidates = [
                [beat || random.bool(rare), random.bool(rare), random.bool(0.3), due && t >= b as usize / 2],
                [beat, random.bool(rare), false, due],
                [beat, false, false, due],
                [true, false, false, due],
                [false, false, false, false],
            ];
            let fits = candidates.iter().find(|row| self.step(&mut hand.clone(), t as i64, row));
            let row = *fits.unwrap_or(&candidates[4]);
            self.step(&mut hand, t as i64, &row);
            rows.push(row);
        }
        rows
    }
}

/// A trace that is hard to predict: every value true half of the time.
pub fn random(steps: usize) -> Vec<Row> {
    let mut random = Random(11);
    (0..steps).map(|_| std::array::from_fn(|_| random.bool(0.5))).collect()
}

fn lower(b: u32) -> u32 {
    b * 3 / 10
}

const NEVER: i64 = i64::MIN / 4;

/// The memory of the hand-written monitors.
#[derive(Clone)]
struct ByHand {
    a: i64,
    b: i64,
    last_p: i64,
    last_not_p: i64,
    last_q: i64,
    last_pq: i64,
    holds_since: bool,
    /// The latest p or q that is at least `a` old, and those that are not yet.
    old: i64,
    young: std::collections::VecDeque<i64>,
    first_unanswered: i64,
    respond_since: bool,
}

impl Default for ByHand {
    fn default() -> ByHand {
        ByHand {
            a: 0,
            b: 0,
            last_p: NEVER,
            last_not_p: NEVER,
            last_q: NEVER,
            last_pq: NEVER,
            holds_since: false,
            old: NEVER,
            young: Default::default(),
            first_unanswered: i64::MAX,
            respond_since: false,
        }
    }
}

impl ByHand {
    #[inline]
    fn recur_glb(&mut self, t: i64, &[p, ..]: &Row) -> bool {
        if p {
            self.last_p = t;
        }
        t - self.last_p <= self.b
    }

    #[inline]
    fn holds_aq(&mut self, t: i64, holds: bool, q: bool) -> bool {
        if q {
            self.last_q = t;
        }
        self.holds_since = q || (self.holds_since && holds);
        t - self.last_q > self.b || self.holds_since
    }

    #[inline]
    fn absent_aq(&mut self, t: i64, &[p, q, ..]: &Row) -> bool {
        self.holds_aq(t, !p, q)
    }

    #[inline]
    fn always_aq(&mut self, t: i64, &[p, q, ..]: &Row) -> bool {
        self.holds_aq(t, p, q)
    }

    #[inline]
    fn absent_br(&mut self, t: i64, &[p, _, r, _]: &Row) -> bool {
        if p {
            self.last_p = t;
        }
        !r || t - self.last_p > self.b
    }

    #[inline]
    fn always_br(&mut self, t: i64, &[p, _, r, _]: &Row) -> bool {
        if !p {
            self.last_not_p = t;
        }
        !r || t - self.last_not_p > self.b
    }

    #[inline]
    fn holds_bqr(&mut self, t: i64, holds: bool, q: bool, r: bool) -> bool {
        if !holds {
            self.young.clear();
            self.old = NEVER;
        }
        if q {
            self.last_q = t;
            self.young.push_back(t);
        }
        self.ripen(t);
        !(r && !q && self.last_q != NEVER) || t - self.old <= self.b
    }

    #[inline]
    fn ripen(&mut self, t: i64) {
        while let Some(&stamp) = self.young.front() {
            if t - stamp < self.a {
                break;
            }
            self.old = stamp;
            self.young.pop_front();
        }
    }

    #[inline]
    fn absent_bqr(&mut self, t: i64, &[p, q, r, _]: &Row) -> bool {
        self.holds_bqr(t, !p, q, r)
    }

    #[inline]
    fn always_bqr(&mut self, t: i64, &[p, q, r, _]: &Row) -> bool {
        self.holds_bqr(t, p, q, r)
    }

    #[inline]
    fn recur_bqr(&mut self, t: i64, &[p, q, r, _]: &Row) -> bool {
        if p || q {
            self.last_pq = t;
        }
        if q {
            self.last_q = t;
        }
        self.holds_since = q || (self.holds_since && t - self.last_pq <= self.b);
        !(r && !q && self.last_q != NEVER) || self.holds_since
    }

    #[inline]
    fn respond_glb(&mut self, t: i64, &[p, _, _, s]: &Row) -> bool {
        if p {
            self.young.push_back(t);
        }
        self.ripen(t);
        let answered = !s || t - self.old <= self.b;
        if s {
            self.first_unanswered = i64::MAX;
        }
        if p {
            self.first_unanswered = self.first_unanswered.min(t);
        }
        answered && (self.first_unanswered == i64::MAX || t - self.first_unanswered < self.b)
    }

    #[inline]
    fn respond_bqr(&mut self, t: i64, row: &Row) -> bool {
        let &[_, q, r, _] = row;
        let holds = self.respond_glb(t, row);
        if q {
            self.last_q = t;
        }
        self.respond_since = q || (self.respond_since && holds);
        !(r && !q && self.last_q != NEVER) || self.respond_since
    }
}

/// A small generator of reproducible chance (SplitMix64).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn bool(&mut self, rate: f64) -> bool {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64 * 1.0 < rate
    }
}
