//! The instances of a group, under `for each` over the values of events.
//!
//! Without slices there is one, and it stays as it is. With slices there may be thousands, of which an event concerns one or two: they lie
//! packed on a shelf ([`mod@crate::pack`]), and the one that is stepped is unpacked into the bench that all share. What keeps much, such as a
//! long window, is not packed but has a core of its own, for packing costs in proportion to what there is.
//!
//! What reads signals as well has a position at every instant. But where nothing in it is due at one, and no event concerns it, that only counts, as for
//! any group that rests or idles: such an instance lies [`still`](Instances::still) until a signal changes, a bound runs out, or an event concerns it. Where
//! some operator has to look at every instant nobody lies still, and every instance has a core of its own.

use alloc::boxed::Box;
use alloc::vec::Vec;

use lapwing_stream::Value;
use serde::{Deserialize, Serialize};

use crate::automaton::{Automaton, Place};
use crate::earliest::Earliest;
use crate::group::{Core, When};
use crate::inputs::{Due, Inputs};
use crate::keys::Keys;
use crate::lanes::{Lanes, Shared};
use crate::pack::{Pack, Packer, Unpacker};
use crate::past::NOW;
use crate::program::{Group, Positions};

/// At most so many instances of a property under `for each` over values.
pub(crate) const INSTANCES: usize = 65_536;

/// The instances of a group: one, or with slices one per value seen, beside the template of those to come.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Instances {
    /// The only instance; with slices the bench, where they are stepped one at a time.
    core: Core,
    /// With slices, all of them.
    shelf: Vec<Kept>,
    keys: Keys,
    deadlines: Earliest,
    /// Of what reads signals: until when each of those on the shelf lies still, if no event concerns it and no signal changes; `None` where all have to
    /// be visited at every instant.
    still: Option<Earliest>,
    /// What the automaton moves of those that are packed.
    lanes: Option<Lanes>,
    /// Those that count as instances, in the order in which their values were seen.
    seen: Vec<u32>,
    pub(crate) too_many: bool,
    /// The moves that all of them make.
    #[serde(skip)]
    pub(crate) automaton: Automaton,
    /// Where each of those on the shelf stands in the automaton, as far as that is known.
    #[serde(skip)]
    places: Vec<Place>,
    #[serde(skip)]
    packer: Packer,
    /// A buffer: those that the events of an instant concern.
    #[serde(skip)]
    concerned: Vec<u32>,
}

/// An instance on the shelf. Its key is kept apart.
#[derive(Clone, Debug, Serialize, Deserialize)]
enum Kept {
    Packed(Box<[u8]>),
    /// It is never packed, or did not fit.
    Whole(Box<Core>),
}

/// The only instance of the only group, where that is all there is.
#[inline]
pub(crate) fn only<'a>(
    plans: &'a [Group],
    groups: &'a mut [Instances],
) -> Option<(&'a Group, &'a mut Automaton, &'a mut Core)> {
    let ([plan], [instances]) = (plans, groups) else { return None };
    let (core, automaton) = instances.alone()?;
    Some((plan, automaton, core))
}

impl Instances {
    pub fn new(plan: &Group, inputs: &Inputs, counters: usize) -> Instances {
        let mut new = Instances {
            core: Core::new(plan, inputs, counters),
            shelf: Vec::new(),
            keys: Keys::new(plan.at.slices.len()),
            deadlines: Earliest::default(),
            still: (plan.at.alphabet.is_none() && (plan.rests || plan.idles)).then(Earliest::default),
            lanes: Lanes::new(plan),
            seen: Vec::new(),
            too_many: false,
            automaton: Automaton::default(),
            places: Vec::new(),
            packer: Packer::default(),
            concerned: Vec::new(),
        };
        if !plan.at.slices.is_empty() {
            new.keys.add_template();
            new.lies_until(0, NOW);
            let mut bytes = Box::default();
            // Where nobody lies still packing would cost time at every instant.
            let may_lie = plan.at.alphabet.is_some() || new.still.is_some();
            let is_packed = may_lie && put_away(0, &mut new.core, (&mut new.packer, &mut bytes), &mut new.lanes);
            new.shelf.push(if is_packed { Kept::Packed(bytes) } else { Kept::Whole(Box::new(new.core.clone())) });
        }
        new
    }

    /// The only instance, where there are no slices.
    #[inline(always)]
    pub fn alone(&mut self) -> Option<(&mut Core, &mut Automaton)> {
        self.shelf.is_empty().then_some((&mut self.core, &mut self.automaton))
    }

    /// Calls with every instance, and every template.
    #[inline]
    pub fn for_each(&mut self, mut step: impl FnMut(&mut Core, &mut Automaton)) {
        if self.shelf.is_empty() {
            return step(&mut self.core, &mut self.automaton);
        }
        for number in 0..self.shelf.len() {
            self.visit(number, &mut step);
            self.lies_until(number, NOW);
        }
    }

    /// Calls with each instance to which this instant, at which `due` is what changed signals made due, may be more than one to count: not with
    /// those that see none of its events.
    #[inline]
    pub fn for_each_concerned(
        &mut self,
        plan: &Group,
        inputs: &Inputs,
        (due, when): (Due, When),
        mut step: impl FnMut(&mut Core, &mut Automaton),
    ) {
        if self.shelf.is_empty() {
            return step(&mut self.core, &mut self.automaton);
        }
        let is_known = self.find_concerned(&plan.at, inputs);
        if self.still.is_some() {
            return self.for_each_restless((plan, is_known), (due, when), step);
        }
        if !is_known {
            return self.for_each(step);
        }
        for i in 0..self.concerned.len() {
            self.visit(self.concerned[i] as usize, &mut step);
        }
    }

    /// Calls with those that do not lie still: everybody where a signal changed, those whose bounds run out, those whom an event concerns, and
    /// those whom one concerned just before, for it is over now. Of those whom nothing but a signal makes do something, the first is
    /// stepped; who makes a move that is known then, and changes nothing that is heard, glides.
    fn for_each_restless(
        &mut self,
        (plan, is_known): (&Group, bool),
        (due, when): (Due, When),
        mut step: impl FnMut(&mut Core, &mut Automaton),
    ) {
        let now = when.now;
        let concerned = core::mem::take(&mut self.concerned);
        let all = due.ops != 0 || !is_known;
        let mask = self.lanes.as_ref().filter(|_| is_known).and_then(|_| Shared::mask(plan, due.ops));
        let mut shared = None;
        let mut events = concerned.iter().map(|&number| number as usize).peekable();
        let mut next = 0;
        while next < self.shelf.len() {
            let restless = if all { Some(next) } else { self.still.as_ref().and_then(|s| s.next_until(next, now)) };
            let Some(number) = restless.into_iter().chain(events.peek().copied()).min() else { break };
            next = number + 1;
            let is_concerned = events.next_if_eq(&number).is_some() || !is_known;
            if !is_concerned && self.glide(number, plan, shared, when) {
                continue;
            }
            let until = self.visit(number, |core, automaton| {
                let remarks = core.walk.remarks();
                step(core, automaton);
                // What there is to remark is to be remarked of each.
                let mask = mask.filter(|_| core.walk.remarks() == remarks);
                shared = shared.or(mask.and_then(|mask| Shared::of(mask, &core.walk, now)));
                core.rests_until()
            });
            if is_concerned || until <= now {
                self.lies_until(number, NOW);
            } else {
                self.lies_until(number, until);
                self.pack_again(number);
            }
        }
        self.concerned = concerned;
    }

    /// Lets one that lies still make its move, where the signals are known to be shared, and the move needs no look at the rest of it.
    #[inline]
    fn glide(&mut self, number: usize, plan: &Group, shared: Option<Shared>, when: When) -> bool {
        let Instances { shelf, still, lanes, places, automaton, .. } = self;
        let (Some(shared), Some(alphabet)) = (shared, plan.alphabet()) else { return false };
        let (Some(Kept::Packed(_)), Some(place)) = (shelf.get(number), places.get_mut(number)) else { return false };
        let (Some(still), Some(lanes)) = (still, lanes) else { return false };
        if still.of(number).is_none_or(|until| until <= when.now) {
            return false;
        }
        let times = (when.now, when.before);
        let until = lanes.glide(number, (place, automaton), (alphabet, plan.heard), shared, times);
        until.map(|until| still.set(number, Some(until))).is_some()
    }

    /// What had too much open to be packed may have little by now.
    fn pack_again(&mut self, number: usize) {
        let Instances { shelf, places, packer, lanes, .. } = self;
        let Some(kept) = shelf.get_mut(number) else { return };
        let mut bytes = Box::default();
        if let Kept::Whole(core) = kept
            && core.margins.is_none()
            && put_away(number, core, (packer, &mut bytes), lanes)
        {
            if places.len() <= number {
                places.resize(number + 1, Place::default());
            }
            places[number] = core.walk.place;
            *kept = Kept::Packed(bytes);
        }
    }

    /// Notes until when one lies still.
    #[inline]
    fn lies_until(&mut self, number: usize, until: i64) {
        if let Some(still) = &mut self.still {
            still.set(number, Some(until));
        }
    }

    /// Calls with each instance that has a deadline up to `now`.
    #[inline]
    pub fn for_each_due(&mut self, now: i64, mut step: impl FnMut(&mut Core)) {
        if self.shelf.is_empty() {
            return step(&mut self.core);
        }
        let mut from = 0;
        while let Some(number) = self.deadlines.next_until(from, now) {
            self.visit(number, |core, _| step(core));
            self.lies_until(number, NOW);
            from = number + 1;
        }
    }

    /// Calls with each instance that has this key: all, where none is given.
    pub fn for_each_of(&mut self, key: Option<&[Value]>, mut step: impl FnMut(&mut Core)) {
        let is_meant = |own: &[Option<Value>]| key.is_none_or(|wanted| own.iter().flatten().eq(wanted));
        if self.shelf.is_empty() && is_meant(&[]) {
            step(&mut self.core);
        }
        for number in 0..self.shelf.len() {
            if is_meant(self.keys.of(number)) {
                self.visit(number, |core, _| step(core));
                self.lies_until(number, NOW);
            }
        }
    }

    /// Calls with the first: what depends on no events is the same in all of them.
    pub fn first<R>(&mut self, step: impl FnOnce(&mut Core) -> R) -> R {
        if self.shelf.is_empty() { step(&mut self.core) } else { self.visit(0, |core, _| step(core)) }
    }

    /// The key and the state of each that counts as an instance, in the order in which their values were seen.
    pub fn look_at_each(&self, mut look: impl FnMut(&[Option<Value>], &Core)) {
        if self.shelf.is_empty() {
            return look(&[], &self.core);
        }
        let mut bench = self.core.clone();
        for &number in &self.seen {
            let core = match self.shelf.get(number as usize) {
                Some(Kept::Packed(bytes)) => {
                    fetch(number as usize, &mut bench, bytes, self.lanes.as_ref());
                    &bench
                }
                Some(Kept::Whole(core)) => core,
                None => continue,
            };
            look(self.keys.of(number as usize), core);
        }
    }

    /// The next time at which a bound of any of them ends.
    #[inline]
    pub fn deadline(&self) -> Option<i64> {
        if self.shelf.is_empty() { self.core.graph.deadline().map(|(at, _)| at) } else { self.deadlines.least() }
    }

    /// Calls with one on the shelf.
    #[inline]
    fn visit<R>(&mut self, number: usize, step: impl FnOnce(&mut Core, &mut Automaton) -> R) -> R {
        let Instances { core: bench, shelf, keys, places, automaton, packer, deadlines, lanes, .. } = self;
        let kept = &mut shelf[number];
        let core = match kept {
            Kept::Packed(bytes) => {
                fetch(number, bench, bytes, lanes.as_ref());
                bench.walk.place = places.get(number).copied().unwrap_or_default();
                &mut *bench
            }
            Kept::Whole(core) => core,
        };
        core.is_instance = keys.are_seen(number);
        keys.swap(number, &mut core.key);
        let result = step(core, automaton);
        keys.swap(number, &mut core.key);
        deadlines.set(number, core.graph.deadline().map(|(at, _)| at));
        if let Kept::Packed(bytes) = kept {
            if places.len() <= number {
                places.resize(number + 1, Place::default());
            }
            places[number] = bench.walk.place;
            if bench.margins.is_some() || !put_away(number, bench, (packer, bytes), lanes) {
                *kept = Kept::Whole(Box::new(bench.clone()));
                bench.margins = None;
            }
        }
        result
    }

    /// Finds those that see an event of this instant. Returns whether that may be fewer than all.
    #[inline(never)]
    fn find_concerned(&mut self, at: &Positions, inputs: &Inputs) -> bool {
        let Instances { keys, concerned, still, .. } = self;
        concerned.clear();
        let Some(slice) = at.slices.first() else { return false };
        // Of what lies still all other events are none that it reads.
        let hidden = slice.hides.iter().map(|(event, _)| event).filter(|_| still.is_some());
        if at.alphabet.is_none() && still.is_none() {
            return false;
        }
        let events = at.alphabet.iter().flatten().chain(hidden);
        for (event, state) in events.filter_map(|&event| inputs.events.get(event).map(|state| (event, state))) {
            let field = slice.hides.iter().find(|(hidden, _)| *hidden == event).map(|(_, field)| *field);
            for fields in state.iter() {
                let value = field.and_then(|field| fields.get(field));
                let Some(numbers) = value.and_then(|value| keys.with(value)) else { return false };
                concerned.extend(numbers);
                // A value that no instance has was one too many: it is one of those that the templates stand for.
                if numbers.is_empty() {
                    concerned.extend(keys.others());
                }
            }
            if state.is_unclear {
                return false;
            }
        }
        concerned.sort_unstable();
        concerned.dedup();
        true
    }

    /// Makes instances for values that are seen for the first time: each goes on from where its template stands.
    ///
    /// Any event with the field makes one, since from then on its slice differs from the others; it counts as an instance once the
    /// slice's own event has had the value.
    pub fn make(&mut self, at: &Positions, inputs: &Inputs) {
        for (i, slice) in at.slices.iter().enumerate() {
            for &(event, field) in &slice.hides {
                let Some(state) = inputs.events.get(event) else { continue };
                for value in state.iter().filter_map(|fields| fields.get(field)).filter(|v| **v != Value::Missing) {
                    self.make_for(i, value);
                    if event == slice.event {
                        self.mark(i, value);
                    }
                }
            }
        }
    }

    /// The `i`-th slice's own event had the value.
    fn mark(&mut self, i: usize, value: &Value) {
        self.find(i, value);
        let Instances { keys, seen, concerned, .. } = self;
        seen.extend(concerned.iter().filter(|&&number| keys.mark(number as usize, i, value)));
    }

    /// Instances for a value of the `i`-th slice, unless there are some.
    fn make_for(&mut self, i: usize, value: &Value) {
        self.find(i, value);
        if !self.concerned.is_empty() {
            return;
        }
        for template in 0..self.shelf.len() {
            if !self.keys.is_template(template, i) {
                continue;
            }
            if self.shelf.len() >= INSTANCES {
                self.too_many = true;
                return;
            }
            let number = self.shelf.len();
            let mut kept = self.shelf[template].clone();
            if let Kept::Whole(core) = &mut kept
                && let Some(margins) = &mut core.margins
            {
                margins.share(number + 1);
            }
            self.shelf.push(kept);
            self.lanes.iter_mut().for_each(|lanes| lanes.add_like(template, number));
            self.keys.add_like(template, i, value);
            self.deadlines.set(number, self.deadlines.of(template));
            self.lies_until(number, NOW);
            let place = self.places.get(template).copied().unwrap_or_default();
            self.places.resize(number, Place::default());
            self.places.push(place);
        }
    }

    /// Finds those with that value of the `i`-th slice.
    fn find(&mut self, i: usize, value: &Value) {
        let Instances { keys, shelf, concerned, .. } = self;
        concerned.clear();
        match keys.with(value).filter(|_| i == 0) {
            Some(found) => concerned.extend(found),
            None => concerned.extend((0..shelf.len() as u32).filter(|&number| keys.has(number as usize, i, value))),
        }
    }
}

/// Unpacks one.
#[inline]
fn fetch(number: usize, core: &mut Core, bytes: &[u8], lanes: Option<&Lanes>) {
    core.unpack(&mut Unpacker::new(bytes));
    lanes.into_iter().for_each(|lanes| lanes.give(number, &mut core.walk));
}

/// Packs one; its lane has what is not in its bytes. Returns whether it could; else it is as it was.
#[inline]
fn put_away(number: usize, core: &mut Core, to: (&mut Packer, &mut Box<[u8]>), lanes: &mut Option<Lanes>) -> bool {
    let (packer, bytes) = to;
    lanes.iter_mut().for_each(|lanes| lanes.take(number, &mut core.walk));
    let fits = packer.pack(core, bytes);
    if !fits {
        lanes.iter().for_each(|lanes| lanes.give(number, &mut core.walk));
    }
    fits
}
