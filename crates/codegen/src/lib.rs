//! Monitors as plain source text: Rust without a standard library, and C99. No allocation, no run time, memory of one fixed size.
//!
//! The way from a checked specification to text:
//!
//! 1. What is asked of arrays and texts becomes inputs (`wholes`), and what cannot be generated is refused, at its place (`refuse`).
//! 2. The compiler lowers the specification to the engine's program, as for a check. What kind of value each signal has is worked out
//!    (`kinds`), and what to call it (`scene`).
//! 3. Expressions (`value`), operators about the past (`past`), scopes (`segments`) and machines (`machines`) become statements of a small
//!    imperative language (`code`).
//! 4. Formulas about the future become automata (`formula`, `residual`, `clock`, `automaton`), and what waits in their states is counted, or queued
//!    where bounds run (`obligations`, `queue`).
//! 5. `assemble` puts it together in the order in which the engine does things, from what comes (`intake`), and when nothing comes (`flips`), to what is said (`verdict`); `fold` works out what is constant, and `prune` drops
//!    what nobody reads.
//! 6. Two printers write it down (`print`). They share everything but syntax.

#![forbid(unsafe_code)]

mod interface;

mod elements;
mod refuse;
mod wholes;

mod kinds;
mod objects;
mod scene;

mod code;
mod fold;
mod prune;

mod frequency;
mod geometry;
mod past;
mod positions;
mod ring;
mod segments;
mod texts;
mod value;

mod automaton;
mod clock;
mod formula;
mod residual;

mod machines;
mod obligations;
mod queue;

mod assemble;
mod flips;
mod intake;
mod verdict;

mod print;

pub use elements::Column;
pub use interface::{From, Interface, Kind, Member, Property, Text};
pub use objects::{Object, Setter, Vector};
pub use texts::Codes;
pub use wholes::{Shape, Whole};

use lapwing_check::checked::{Body, Spec};
use lapwing_check::compile::compile;
use lapwing_diag::{Diagnostic, Span};

use formula::Beyond;
use interface::{Names, identifier};
use refuse::{late_bound, refusal, refused};
use scene::{Scene, has_odd_comparisons};

/// A language.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Language {
    /// A module for crates without a standard library.
    Rust,
    /// C99: a header and a source file.
    C,
}

/// What to generate, and how.
#[derive(Clone, PartialEq, Debug)]
pub struct Options {
    /// The language.
    pub language: Language,
    /// What files and the names of C begin with; made an identifier.
    pub name: String,
    /// How much of anything is queued whose number the specification does not bound, at least 4.
    pub capacity: usize,
    /// The properties; none for all.
    pub properties: Vec<String>,
}

/// Generated monitors.
#[derive(Clone, Debug, PartialEq)]
pub struct Generated {
    /// Names and texts of files.
    pub files: Vec<(String, String)>,
    /// What they take and say.
    pub interface: Interface,
}

/// The capacity where none is given.
pub const CAPACITY: usize = 64;

/// Why properties cannot be generated, as far as the text of each tells, with their names. An empty list says that one can.
pub fn refusals(spec: &Spec) -> Vec<(String, Vec<Diagnostic>)> {
    let mut unfolded = spec.clone();
    wholes::unfold(&mut unfolded, &mut Names::default());
    unfolded.properties.iter().map(|p| (p.name.clone(), refused(&unfolded, p))).collect()
}

/// Generates the monitors of a specification that was checked without errors. `title` is what reports call it.
pub fn generate(spec: &Spec, title: &str, options: &Options) -> Result<Generated, Vec<Diagnostic>> {
    let mut chosen = choose(spec, options);
    let mut setters = Names::default();
    let mut wholes = wholes::unfold(&mut chosen, &mut setters);
    let found: Vec<Diagnostic> = chosen.properties.iter().flat_map(|p| refused(&chosen, p)).collect();
    if !found.is_empty() {
        return Err(once_each(found));
    }
    let program = compile(&chosen);
    let scene = Scene::new(&chosen, &program);
    clashes(&chosen, &scene)?;
    let unit = assemble::assemble(&scene, room(options))
        .map_err(|(property, beyond)| vec![beyond_of(&chosen, property, beyond)])?;
    wholes::add_codes(&mut wholes, &scene, &mut setters);
    let objects = objects::objects(&scene, &mut setters);
    let interface = interface(&scene, title, options, (wholes, objects), &unit);
    let files = match options.language {
        Language::Rust => vec![(format!("{}.rs", interface.prefix), print::rust(&unit, &interface))],
        Language::C => {
            let (header, source) = print::c(&unit, &interface);
            vec![(format!("{}.h", interface.prefix), header), (format!("{}.c", interface.prefix), source)]
        }
    };
    Ok(Generated { files, interface })
}

/// How much of anything there is room for.
fn room(options: &Options) -> usize {
    options.capacity.clamp(4, 1 << 20)
}

/// The specification with the wanted properties alone.
fn choose(spec: &Spec, options: &Options) -> Spec {
    let mut chosen = spec.clone();
    if !options.properties.is_empty() {
        chosen.properties.retain(|p| options.properties.contains(&p.name));
    }
    chosen.reactions.clear();
    chosen
}

/// What several properties read is refused once.
fn once_each(found: Vec<Diagnostic>) -> Vec<Diagnostic> {
    let mut once: Vec<Diagnostic> = Vec::new();
    for diagnostic in found {
        if !once.contains(&diagnostic) {
            once.push(diagnostic);
        }
    }
    once
}

/// Where a property stands.
fn place(spec: &Spec, property: usize) -> Option<Span> {
    spec.properties.get(property).or(spec.properties.first()).map(|p| p.span)
}

/// Signals of which nobody knows what kind of value they have.
fn clashes(spec: &Spec, scene: &Scene<'_>) -> Result<(), Vec<Diagnostic>> {
    let Some(place) = place(spec, 0) else { return Ok(()) };
    let name = |from: &From| match from {
        From::Input(i) => spec.inputs[*i].label.clone(),
        From::Event(e) | From::EventField(e, _) => spec.events[*e].name.clone(),
        From::Topic(t) => spec.topics[*t].name.clone(),
        From::Pose(o) | From::Twist(o) | From::Part(o, _) => spec.objects[*o].name.clone(),
    };
    let mut found: Vec<Diagnostic> = scene
        .kinds
        .clashes
        .iter()
        .map(|from| {
            let message = format!("`{}` is taken for values of two kinds", name(from));
            refusal(place, message, "declare it with its type: `decl speed /speed Float64.data`")
        })
        .collect();
    if has_odd_comparisons(scene.program, &scene.kinds) {
        found.push(refusal(
            place,
            "values of two kinds are compared",
            "compare numbers with numbers, and texts with texts: a signal's declaration says which it is",
        ));
    }
    if found.is_empty() { Ok(()) } else { Err(found) }
}

fn beyond_of(spec: &Spec, property: usize, beyond: Beyond) -> Diagnostic {
    let late = spec.properties.get(property).filter(|_| beyond == Beyond::LateBound).and_then(late_bound);
    let span = late.or(place(spec, property)).unwrap_or_default();
    let (message, help) = match beyond {
        Beyond::OpensLate => ("a scope of this property opens or closes on a formula about the future", ""),
        Beyond::LateBound => (
            "a bound below another operator of the future, that would need a clock for each position",
            "give the inner formula a property of its own",
        ),
        Beyond::TooLarge => ("the automaton of this formula has too many states", "split it into several properties"),
    };
    refusal(span, message, help)
}

fn interface(
    scene: &Scene<'_>,
    title: &str,
    options: &Options,
    taken: (Vec<Whole>, Vec<Object>),
    unit: &code::Unit,
) -> Interface {
    let mut names = Names::default();
    let property = |p: &lapwing_check::checked::Property| Property {
        name: p.name.clone(),
        macro_name: names.give(&identifier(&p.name).to_uppercase()),
        line: p.line,
        text: match p.body {
            // The text of a machine is a page.
            Body::Machine(_) => p.text.lines().next().unwrap_or_default().to_owned(),
            _ => p.text.clone(),
        },
    };
    let any = |is: fn(&code::Expr) -> bool| {
        unit.functions.iter().any(|f| {
            let mut found = false;
            prune::reads(&f.body, &mut |e| prune::below(e, &mut |e| found |= is(e)));
            found
        })
    };
    Interface {
        wholes: taken.0,
        objects: taken.1,
        prefix: identifier(&options.name).to_lowercase(),
        spec: title.split(char::is_control).collect::<Vec<_>>().join(" "),
        properties: scene.spec.properties.iter().map(property).collect(),
        members: scene.members.values().cloned().collect(),
        texts: scene.texts.clone(),
        codes: scene.codes,
        capacity: room(options),
        needs_libm: (any(print::needs_libm), any(print::needs_math)),
    }
}
