//! The call sites of the program as they register, and what is to be done at each.
//!
//! `tracing` registers a call site when it is passed for the first time, and asks every subscriber once whether it wants it; the answer is
//! kept. So a call site that nobody wants costs what `tracing` itself costs, and what a call site means is worked out once.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::hash::{BuildHasherDefault, Hasher};
use std::sync::{Arc, PoisonError, RwLock};

use lapwing::Unseen;
use tracing::Metadata;
use tracing::callsite::Identifier;

use crate::hints;
use crate::site::Site;
use crate::wants::{Need, Oneness, Place, PlaceKind, Wants};

/// What is done at a call site that somebody wants.
#[derive(Clone, Debug)]
pub(crate) enum Entry {
    /// It gives values, raises events, is a span that matters.
    Site(Arc<Site>),
    /// It is the event that `#[instrument(ret)]` or `#[instrument(err)]` makes of a function that matters.
    Return,
}

/// The call sites that have registered.
#[derive(Debug)]
pub(crate) struct Sites {
    wants: Wants,
    table: RwLock<Table>,
}

#[derive(Debug, Default)]
struct Table {
    entries: HashMap<Identifier, Option<Entry>, BuildHasherDefault<ByAddress>>,
    known: Vec<&'static Metadata<'static>>,
    /// The call sites of a program that has `log` only, by target, then by the event that their message names and their keys.
    #[cfg(feature = "log")]
    logs: HashMap<String, Vec<Logged>>,
    /// How many they are.
    #[cfg(feature = "log")]
    logged: usize,
    /// Who gives what.
    givers: BTreeMap<Need, Vec<Giver>>,
    /// What two give that are not the same.
    barred: BTreeSet<Need>,
}

/// Records of `log` that are treated alike.
#[cfg(feature = "log")]
#[derive(Debug)]
struct Logged {
    event: String,
    keys: Vec<String>,
    site: Option<Arc<Site>>,
}

/// So many kinds of records are remembered: targets and keys may be made up as the program goes.
#[cfg(feature = "log")]
const MOST_LOGGED: usize = 4096;

/// A call site that gives something.
#[derive(Clone, PartialEq, Debug)]
struct Giver {
    name: String,
    target: String,
    file: Option<String>,
    line: Option<u32>,
}

impl Giver {
    fn place(&self) -> String {
        match (&self.file, self.line) {
            (Some(file), Some(line)) => format!("{}::{} ({file}:{line})", self.target, self.name),
            _ => format!("{}::{}", self.target, self.name),
        }
    }
}

impl Sites {
    pub fn new(wants: Wants) -> Sites {
        Sites { wants, table: RwLock::default() }
    }

    pub fn wants(&self) -> &Wants {
        &self.wants
    }

    /// Takes a call site in; whether somebody wants it.
    pub fn register(&self, metadata: &'static Metadata<'static>) -> bool {
        if let Some(known) = self.read(|table| table.entries.get(&metadata.callsite()).map(Option::is_some)) {
            return known;
        }
        self.write(|table| {
            let newly_barred = with_place(metadata, |place| table.note(&self.wants, place));
            table.known.push(metadata);
            if newly_barred {
                table.replan(&self.wants);
            } else {
                table.plan(&self.wants, metadata);
            }
            table.entries.get(&metadata.callsite()).is_some_and(Option::is_some)
        })
    }

    /// What is to be done at a call site.
    #[inline]
    pub fn entry(&self, metadata: &Metadata<'_>) -> Option<Entry> {
        self.read(|table| table.entries.get(&metadata.callsite()).cloned().flatten())
    }

    /// What is to be done with a record of `log`.
    #[cfg(feature = "log")]
    pub fn of_log(&self, place: &Place<'_>) -> Option<Arc<Site>> {
        let is_same = |logged: &&Logged| {
            logged.event == place.name && logged.keys.iter().map(String::as_str).eq(place.fields.iter().copied())
        };
        let find = |table: &Table| table.logs.get(place.target)?.iter().find(is_same).map(|logged| logged.site.clone());
        if let Some(known) = self.read(find) {
            return known;
        }
        self.write(|table| {
            if table.note(&self.wants, place) {
                table.replan(&self.wants);
            }
            let site = self.wants.plan(place, &table.barred).map(Arc::new);
            if table.logged < MOST_LOGGED {
                let keys = place.fields.iter().map(|&key| key.to_owned()).collect();
                let logged = Logged { event: place.name.to_owned(), keys, site: site.clone() };
                table.logs.entry(place.target.to_owned()).or_default().push(logged);
                table.logged += 1;
            }
            site
        })
    }

    /// What no call site gave, and what nobody can tell because two did: `raised` says which events somebody has raised all the same,
    /// `assumed` which functions and fields are there even if they were never reached.
    pub fn unseen(&self, raised: &[bool], assumed: &BTreeSet<String>) -> Unseen {
        let mut unseen = Unseen::default();
        for (event, was_raised) in raised.iter().enumerate() {
            let needs = self.wants.needs_of(event);
            let doubt = needs.iter().find_map(|need| self.doubt(*need)).or_else(|| self.missing_result(event));
            let missing = || needs.iter().filter(|_| !was_raised).find_map(|need| self.missing(*need, assumed));
            if let Some(cause) = doubt.or_else(missing) {
                unseen.events.insert(event, cause);
            }
        }
        let doubtful = (0..self.wants.columns()).filter_map(|c| Some((c, self.doubt(Need::Column(c))?)));
        unseen.columns.extend(doubtful);
        unseen
    }

    /// Signals that no call site gives, but one that is called alike may be meant to.
    pub fn misnamed(&self, assumed: &BTreeSet<String>) -> Vec<String> {
        let misnamed = |column: usize| {
            let name = self.wants.name(Need::Column(column));
            let hint = self.read(|table| {
                let is_given = assumed.contains(&name) || table.givers.contains_key(&Need::Column(column));
                if is_given { String::new() } else { hints::field(&name, &table.known) }
            });
            (!hint.is_empty()).then(|| format!("no field `{name}` was seen{hint}"))
        };
        (0..self.wants.columns()).filter_map(misnamed).collect()
    }

    /// Why nobody can tell what gives something: two do.
    fn doubt(&self, need: Need) -> Option<String> {
        self.read(|table| table.barred.contains(&need).then(|| self.two(table, need)))
    }

    /// Why something was never given.
    fn missing(&self, need: Need, assumed: &BTreeSet<String>) -> Option<String> {
        let name = self.wants.name(need);
        let is_there = assumed.contains(&name) || self.read(|table| table.givers.contains_key(&need));
        if is_there {
            return None;
        }
        let (what, hint) = self.read(|table| match self.wants.oneness(need) {
            Oneness::Module => ("field", hints::field(&name, &table.known)),
            Oneness::Function | Oneness::Any => ("function", hints::function(&name, &table.known)),
        });
        Some(format!(
            "no {what} `{name}` was seen: it was never reached, is not instrumented, or a filter turns it off{hint}"
        ))
    }

    /// A function whose result is asked for, but that does not record it; one that does, but of which nobody knew that when it ended otherwise.
    fn missing_result(&self, event: usize) -> Option<String> {
        let is_silent = |entry: &&Entry| match entry {
            Entry::Site(site) => {
                let returns = site.span.iter().flat_map(|span| &span.returns);
                site.origin.has_ended_without_return() && returns.into_iter().any(|r| r.event == event)
            }
            Entry::Return => false,
        };
        let records_result = |entry: &Entry| matches!(entry, Entry::Site(site) if site.origin.records_result());
        let found = self.read(|table| table.entries.values().flatten().find(is_silent).map(records_result))?;
        let name = self.wants.name(Need::Event(event));
        match found {
            true => Some(format!(
                "a future of `{name}` was dropped before it was done, and taken for done: it was the first, and nothing had said yet that \
                 `{name}` records what it returns"
            )),
            false if self.wants.wants_result(event) => Some(format!(
                "`{name}` ended without recording what it returned: `#[instrument(ret)]` does; where that is there already, its future was \
                 dropped before it was done"
            )),
            false => None,
        }
    }

    fn two(&self, table: &Table, need: Need) -> String {
        let givers = table.givers.get(&need).map_or(&[][..], Vec::as_slice);
        let places: Vec<String> = givers.iter().map(Giver::place).collect();
        format!("`{}` may be {}: say which by the modules around it", self.wants.name(need), places.join(" or "))
    }

    fn read<T>(&self, look: impl FnOnce(&Table) -> T) -> T {
        look(&self.table.read().unwrap_or_else(PoisonError::into_inner))
    }

    fn write<T>(&self, change: impl FnOnce(&mut Table) -> T) -> T {
        change(&mut self.table.write().unwrap_or_else(PoisonError::into_inner))
    }
}

impl Table {
    /// Notes what a call site gives. Returns whether something is given by two now that are not the same.
    fn note(&mut self, wants: &Wants, place: &Place<'_>) -> bool {
        let giver = Giver {
            name: place.name.to_owned(),
            target: place.target.to_owned(),
            file: place.file.map(str::to_owned),
            line: place.line,
        };
        let before = self.barred.len();
        for need in wants.given_by(place) {
            let givers = self.givers.entry(need).or_default();
            let is_other = |known: &Giver| match wants.oneness(need) {
                Oneness::Function => *known != giver,
                Oneness::Module => known.target != giver.target,
                Oneness::Any => false,
            };
            if givers.is_empty() {
                givers.push(giver.clone());
            } else if givers.iter().all(is_other) {
                givers.push(giver.clone());
                self.barred.insert(need);
            }
        }
        self.barred.len() > before
    }

    /// Works out what is to be done at a call site.
    fn plan(&mut self, wants: &Wants, metadata: &'static Metadata<'static>) {
        let entry = with_place(metadata, |place| match self.is_return(place) {
            true => Some(Entry::Return),
            false => wants.plan(place, &self.barred).map(|site| Entry::Site(Arc::new(site))),
        });
        self.entries.insert(metadata.callsite(), entry);
    }

    /// The same for all, since something is given by two.
    fn replan(&mut self, wants: &Wants) {
        self.known.clone().into_iter().for_each(|metadata| self.plan(wants, metadata));
        #[cfg(feature = "log")]
        {
            self.logs.clear();
            self.logged = 0;
        }
    }

    /// Whether it is what `#[instrument]` makes of the return of a function that matters: it stands where the function's span does, which
    /// registered before it.
    fn is_return(&self, place: &Place<'_>) -> bool {
        let is_it = |entry: &Entry| match entry {
            Entry::Site(site) => has_returns(site) && site.origin.is_at(place.file, place.line),
            Entry::Return => false,
        };
        let looks_so = place.kind == PlaceKind::Event && matches!(place.fields, ["return"] | ["error"]);
        looks_so && self.entries.values().flatten().any(is_it)
    }
}

fn has_returns(site: &Site) -> bool {
    site.span.as_ref().is_some_and(|span| !span.returns.is_empty())
}

/// A call site of `tracing` as a place.
fn with_place<T>(metadata: &'static Metadata<'static>, look: impl FnOnce(&Place<'_>) -> T) -> T {
    let fields: Vec<&str> = metadata.fields().iter().map(|f| f.name()).collect();
    look(&Place {
        kind: if metadata.is_span() { PlaceKind::Span } else { PlaceKind::Event },
        name: metadata.name(),
        target: metadata.target(),
        fields: &fields,
        file: metadata.file(),
        line: metadata.line(),
    })
}

/// Call sites are told apart by their addresses, which need little mixing.
#[derive(Clone, Copy, Default)]
pub(crate) struct ByAddress(u64);

impl Hasher for ByAddress {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|&byte| self.write_u64(u64::from(byte)));
    }

    fn write_u64(&mut self, n: u64) {
        // The multiplier of Fibonacci hashing (Knuth, The Art of Computer Programming, volume 3, section 6.4).
        self.0 = (self.0.rotate_left(5) ^ n).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        self.0 ^= self.0 >> 32;
    }

    fn write_usize(&mut self, n: usize) {
        self.write_u64(n as u64);
    }
}
