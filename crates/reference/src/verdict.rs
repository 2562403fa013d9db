//! The verdict of each property (language reference, *Verdicts*; jumps of time: *Traces, instants, values*).

use crate::course::{Course, Needs, in_slices};
use crate::machines::{self, MachineLog};
use crate::obligations::{self, Episode, Tally};
use crate::piece::Piece;
use crate::trace::{Arrival, Trace};
use crate::{margin, vacuity};
use lapwing_check::checked::{
    self, Body, EventSource, Expr, InputSource, Kind, ObjectSource, Property, ReadOf, Slice, Spec,
};
use lapwing_stream::{Time, Value, Verdict};

/// What came out for one property, or for one instance of it.
#[derive(Clone, PartialEq, Debug)]
pub struct Outcome {
    /// The property's name, with its instance.
    pub name: String,
    /// The verdict.
    pub verdict: Verdict,
    /// Why it is inconclusive.
    pub cause: Option<String>,
    /// Whether it is a success that some scope or `whenever` had no part in.
    pub vacuous: bool,
    /// How often each scope and `whenever` was entered, in the order in which they are written.
    pub entered: Vec<usize>,
    /// Obligations met.
    pub met: usize,
    /// Obligations failed.
    pub failed: usize,
    /// Obligations still open at the end of a piece.
    pub open: usize,
    /// The failed ones by episodes: by the first failure, then by the beginning, piece after piece.
    pub episodes: Vec<Episode>,
    /// The number of positions of the property.
    pub instants: usize,
    /// The worst robustness of an obligation; `None` where there is none.
    pub margin: Option<f64>,
}

/// Judges every property of a specification on a trace, in order; a property under `for each … of` once per value seen.
///
/// ```
/// use lapwing_check::{TraceShape, check, load};
/// use lapwing_reference::{Arrival, Trace, evaluate};
/// use lapwing_stream::{Time, Value, Verdict};
///
/// let text = "whenever cmd > 0, eventually within 1 s speed > 0\n";
/// let mut sources = lapwing_diag::SourceMap::default();
/// let file = sources.add("robot.rv", text);
/// let loaded = load(&mut sources, lapwing_syntax::parse(file, text).file, &|_| None);
/// let columns = ["cmd", "speed"].map(String::from).to_vec();
/// let shape = TraceShape { columns, schemaless: true, ..TraceShape::default() };
/// let spec = check(&sources, &loaded, Some(&shape)).spec;
///
/// // The robot is told to move at 0 s and has not moved by 1 s.
/// let row = |seconds: i64| {
///     let value = |name: &String| Value::Num(if name == "cmd" && seconds == 0 { 1.0 } else { 0.0 });
///     (Time(seconds * 1_000_000_000), Arrival::Row { cells: spec.columns.iter().map(value).collect() })
/// };
/// let trace = Trace { samples: vec![row(0), row(1), row(2)], ..Trace::default() };
/// let outcome = &evaluate(&spec, &trace)[0];
/// assert_eq!(outcome.verdict, Verdict::Violated);
/// assert_eq!((outcome.episodes[0].began, outcome.episodes[0].failed), (Time(0), Time(1_000_000_000)));
/// ```
pub fn evaluate(spec: &Spec, trace: &Trace) -> Vec<Outcome> {
    let pieces: Vec<Piece<'_>> = trace.pieces(spec).into_iter().map(|samples| Piece::new(spec, samples)).collect();
    let worlds: Vec<World<'_>> = pieces.iter().map(World::new).collect();
    spec.properties.iter().flat_map(|property| judge_instances(property, &worlds, trace)).collect()
}

/// A piece and what the machines did in it.
struct World<'a> {
    piece: &'a Piece<'a>,
    logs: Vec<MachineLog>,
    runs: Vec<machines::Run>,
}

impl<'a> World<'a> {
    /// Runs the machines, each after those that it reads.
    fn new(piece: &'a Piece<'a>) -> World<'a> {
        let mut world = World { piece, logs: Vec::new(), runs: Vec::new() };
        for machine in 0..piece.spec.machines.len() {
            let (log, run) = machines::run(piece, machine, &world.logs);
            world.logs.push(log);
            world.runs.push(run);
        }
        world
    }
}

/// What came out on one piece.
struct PieceOutcome {
    verdict: Verdict,
    cause: Option<String>,
    entered: Vec<usize>,
    tally: Tally,
    instants: usize,
    margin: Option<f64>,
}

impl PieceOutcome {
    /// It could not even be looked at.
    fn inconclusive(property: &Property, cause: String) -> PieceOutcome {
        let scopes = match &property.body {
            Body::Formula(formula) => vacuity::count(formula),
            Body::Machine(_) | Body::None => 0,
        };
        PieceOutcome {
            verdict: Verdict::Inconclusive,
            cause: Some(cause),
            entered: vec![0; scopes],
            tally: Tally::default(),
            instants: 0,
            margin: None,
        }
    }
}

/// The values of an instance's slices, outermost first.
type Instance = Vec<Value>;

fn judge_instances(property: &Property, worlds: &[World<'_>], trace: &Trace) -> Vec<Outcome> {
    let bare =
        |cause: &str| vec![merge(property.name.clone(), vec![PieceOutcome::inconclusive(property, cause.into())])];
    if let Some(problem) = &property.problem {
        return bare(problem);
    }
    if worlds.is_empty() {
        return bare("the trace has no message at all");
    }
    let mut instances: Vec<Instance> = Vec::new();
    for world in worlds {
        for instance in instances_in(property, world.piece) {
            if !instances.contains(&instance) {
                instances.push(instance);
            }
        }
    }
    if instances.is_empty() {
        return bare("no value was seen to make an instance of");
    }
    let mut outcomes = Vec::new();
    for instance in instances {
        let mut pieces = Vec::new();
        for (n, world) in worlds.iter().enumerate() {
            // Nothing is carried over a jump: a piece knows the values that are seen in it.
            if instances_in(property, world.piece).contains(&instance) {
                let is_last = n + 1 == worlds.len();
                pieces.push(judge_piece(property, &instance, world, trace, is_last));
            }
        }
        outcomes.push(merge(instance_name(&property.name, &instance), pieces));
    }
    outcomes
}

/// The instances of a property in a piece, in the order in which their values are first seen; one without slices.
fn instances_in(property: &Property, piece: &Piece<'_>) -> Vec<Instance> {
    let mut instances: Vec<Instance> = vec![Vec::new()];
    for (depth, slice) in property.slices.iter().enumerate() {
        let outer = &property.slices[..depth];
        let longer = |i: &Instance| -> Vec<Instance> {
            let around: Vec<(&Slice, Value)> = outer.iter().zip(i.iter().cloned()).collect();
            let values = values_seen(piece, slice, &around);
            values.into_iter().map(|v| i.iter().cloned().chain([v]).collect()).collect()
        };
        instances = instances.iter().flat_map(longer).collect();
    }
    instances
}

/// The values of a slice's event that occur inside the slices around it.
fn values_seen(piece: &Piece<'_>, slice: &Slice, around: &[(&Slice, Value)]) -> Vec<Value> {
    let declared = &piece.spec.events[slice.event];
    let Some(field) = declared.fields.iter().position(|f| f.path == slice.field) else { return Vec::new() };
    let mut seen: Vec<Value> = Vec::new();
    for occurrence in piece.occurrences.iter().flatten() {
        if occurrence.event == slice.event && in_slices(occurrence, around) {
            let value = occurrence.values.get(field).cloned().unwrap_or_default();
            // NaN is equal to nothing, so no event would be in its slice.
            let is_one = !matches!(value, Value::Missing) && !matches!(value, Value::Num(x) if x.is_nan());
            if is_one && !seen.contains(&value) {
                seen.push(value);
            }
        }
    }
    seen
}

/// `p[a][b]`: texts bare, whole numbers as integers.
fn instance_name(name: &str, instance: &[Value]) -> String {
    let mut full = name.to_string();
    for value in instance {
        let shown = match value {
            Value::Str(s) => s.clone(),
            Value::Num(x) => x.to_string(),
            Value::Bool(b) => b.to_string(),
            other => other.kind().to_string(),
        };
        full.push_str(&format!("[{shown}]"));
    }
    full
}

/// Judges one instance of a property on one piece.
fn judge_piece(
    property: &Property,
    instance: &[Value],
    world: &World<'_>,
    trace: &Trace,
    is_last: bool,
) -> PieceOutcome {
    if world.piece.samples.is_empty() {
        return PieceOutcome::inconclusive(property, "no message".into());
    }
    let found = match &property.body {
        Body::Formula(formula) => judge_formula(property, formula, instance, world, trace),
        Body::Machine(machine) => judge_machine(*machine, world, trace),
        Body::None => Err("it could not be evaluated".into()),
    };
    match found {
        Ok(found) => found.conclude(trace, is_last),
        Err(cause) => PieceOutcome::inconclusive(property, cause),
    }
}

/// A formula on a piece, or why it never starts.
fn judge_formula(
    property: &Property,
    formula: &Expr,
    instance: &[Value],
    world: &World<'_>,
    trace: &Trace,
) -> Result<Found, String> {
    let needs = Needs {
        exprs: vec![formula],
        reads: &property.reads,
        machines: property.machines.clone(),
        alphabet: property.alphabet.as_deref(),
        slices: property.slices.iter().zip(instance.iter().cloned()).collect(),
    };
    let course = Course::new(world.piece, &world.logs, &needs);
    if !course.starts() {
        return Err(never_starts(&property.reads, world.piece));
    }
    let judged = obligations::judge(&course, formula);
    Ok(Found {
        tally: judged.tally,
        unmet: judged.unmet,
        may_grow: judged.may_grow,
        fault: course
            .fault()
            .or_else(|| blind(world.piece, &needs, trace))
            .or_else(|| unknown_moves(&needs, world, trace)),
        entered: vacuity::entries(&course, formula),
        instants: course.len(),
        margin: margin::of(&course, formula).filter(|_| course.spoilt().is_none()),
    })
}

/// A machine's own property on a piece, or why it never starts.
fn judge_machine(machine: usize, world: &World<'_>, trace: &Trace) -> Result<Found, String> {
    let run = &world.runs[machine];
    let needs = machines::needs(world.piece.spec, machine);
    if !run.starts {
        return Err(never_starts(needs.reads, world.piece));
    }
    Ok(Found {
        tally: run.tally.clone(),
        unmet: run.unmet,
        // There can always be another move.
        may_grow: true,
        fault: machine_fault(machine, world, trace),
        entered: Vec::new(),
        instants: run.positions,
        margin: None,
    })
}

/// Why nobody can tell what a machine did, or all of it.
fn machine_fault(machine: usize, world: &World<'_>, trace: &Trace) -> Option<String> {
    let run = &world.runs[machine];
    let needs = machines::needs(world.piece.spec, machine);
    if !run.starts {
        return Some(never_starts(needs.reads, world.piece));
    }
    let blind = || blind(world.piece, &needs, trace);
    run.fault.clone().or_else(blind).or_else(|| unknown_moves(&needs, world, trace))
}

/// Why nobody can tell when the events of machines occurred that something over events alone steps on.
fn unknown_moves(needs: &Needs<'_>, world: &World<'_>, trace: &Trace) -> Option<String> {
    let events = needs.alphabet.unwrap_or_default().iter();
    let mut machines = events.filter_map(|&event| world.piece.spec.events[event].source.machine());
    machines.find_map(|machine| machine_fault(machine, world, trace))
}

/// All that decides the verdict on a piece.
struct Found {
    tally: Tally,
    unmet: bool,
    may_grow: bool,
    /// Why it could not be judged, unless it is violated.
    fault: Option<String>,
    entered: Vec<usize>,
    instants: usize,
    margin: Option<f64>,
}

impl Found {
    fn conclude(self, trace: &Trace, is_last: bool) -> PieceOutcome {
        let (verdict, cause) = if self.tally.failed > 0 {
            (Verdict::Violated, None)
        } else if let Some(fault) = self.fault {
            (Verdict::Inconclusive, Some(fault))
        } else if self.unmet && !is_last {
            (Verdict::Inconclusive, Some("time jumped".into()))
        } else if self.unmet && trace.broke_off.is_some() {
            (Verdict::Inconclusive, trace.broke_off.clone())
        } else if self.unmet {
            (Verdict::Unmet, None)
        } else if self.tally.open == 0 && !self.may_grow {
            (Verdict::Satisfied, None)
        } else {
            (Verdict::Holds, None)
        };
        let Found { tally, entered, instants, margin, .. } = self;
        PieceOutcome { verdict, cause, entered, tally, instants, margin }
    }
}

/// The worst of the pieces; counts are summed, episodes follow one another.
fn merge(name: String, pieces: Vec<PieceOutcome>) -> Outcome {
    let verdict = pieces.iter().map(|p| p.verdict).min().unwrap_or(Verdict::Inconclusive);
    let cause = pieces.iter().find(|p| p.verdict == verdict).and_then(|p| p.cause.clone());
    let scopes = pieces.iter().map(|p| p.entered.len()).max().unwrap_or(0);
    let entered: Vec<usize> = (0..scopes).map(|n| pieces.iter().filter_map(|p| p.entered.get(n)).sum()).collect();
    Outcome {
        name,
        verdict,
        cause,
        vacuous: verdict.is_success() && entered.contains(&0),
        met: pieces.iter().map(|p| p.tally.met).sum(),
        failed: pieces.iter().map(|p| p.tally.failed).sum(),
        open: pieces.iter().map(|p| p.tally.open).sum(),
        instants: pieces.iter().map(|p| p.instants).sum(),
        margin: pieces.iter().filter_map(|p| p.margin).reduce(f64::min),
        episodes: pieces.into_iter().flat_map(|p| p.tally.episodes).collect(),
        entered,
    }
}

/// Names what a property waited for in vain.
fn never_starts(reads: &[checked::Read], piece: &Piece<'_>) -> String {
    let spec = piece.spec;
    let end = piece.samples.len();
    let mut missing = Vec::new();
    for read in reads {
        match read.what {
            ReadOf::Input(input) if piece.latest[end][input].is_none() => {
                missing.push(format!("no value of {}", spec.inputs[input].label));
            }
            ReadOf::Topic(topic) if piece.messages(topic, end).is_empty() => {
                missing.push(format!("no message on {}", spec.topics[topic].name));
            }
            _ => {}
        }
    }
    missing.dedup();
    if missing.is_empty() { "the trace is too short to look so far back".into() } else { missing.join(", ") }
}

/// Why what has these needs cannot be trusted: silence for too long, or something lost.
fn blind(piece: &Piece<'_>, needs: &Needs<'_>, trace: &Trace) -> Option<String> {
    let spec = piece.spec;
    let Sources { inputs, topics } = sources(spec, needs);
    let stale = inputs.iter().find(|&&i| is_stale(piece, i)).map(|&i| format!("{} is stale", spec.inputs[i].label));
    let lost = trace.lost.iter().find(|(topic, _)| topics.contains(topic));
    stale.or_else(|| lost.map(|(_, why)| why.clone()))
}

/// What something reads: the inputs, those with a default too, and the topics.
struct Sources {
    inputs: Vec<usize>,
    topics: Vec<usize>,
}

fn sources(spec: &Spec, needs: &Needs<'_>) -> Sources {
    let (mut inputs, mut topics) = (Vec::new(), Vec::new());
    for read in needs.reads {
        match read.what {
            ReadOf::Input(input) => inputs.push(input),
            ReadOf::Topic(topic) => topics.push(topic),
        }
    }
    let mut events = needs.alphabet.unwrap_or_default().to_vec();
    let mut open: Vec<&Expr> = needs.exprs.clone();
    while let Some(e) = open.pop() {
        match e.kind {
            Kind::Input(input) => inputs.push(input),
            Kind::Event(event) | Kind::EventField { event, .. } => events.push(event),
            _ => {}
        }
        open.extend(e.children());
    }
    for &event in &events {
        if let EventSource::Message { topic } = spec.events[event].source {
            topics.push(topic);
        }
    }
    inputs.sort_unstable();
    inputs.dedup();
    topics.extend(inputs.iter().flat_map(|&i| topics_of(spec, i)));
    Sources { inputs, topics }
}

/// The topics from which an input has its values.
fn topics_of(spec: &Spec, input: usize) -> Vec<usize> {
    match &spec.inputs[input].source {
        InputSource::Field { topic, .. } => vec![*topic],
        InputSource::Column(_) => Vec::new(),
        InputSource::World { object, .. } => match &spec.objects[*object].source {
            ObjectSource::ModelStates { topic, .. } => vec![*topic],
            ObjectSource::Odometry { topic, .. } | ObjectSource::Pose { topic, .. } => vec![*topic],
            ObjectSource::Tf { topics, .. } => topics.iter().map(|(topic, _)| *topic).collect(),
        },
    }
}

/// Whether an input's source was silent for longer than it may: at the beginning, between two messages, or at the end.
fn is_stale(piece: &Piece<'_>, input: usize) -> bool {
    let (Some(limit), Some(t0)) = (piece.spec.inputs[input].stale, piece.t0) else { return false };
    let topics = topics_of(piece.spec, input);
    let heard = |arrival: &Arrival| match (arrival, &piece.spec.inputs[input].source) {
        (Arrival::Row { cells }, InputSource::Column(column)) => {
            cells.get(*column).is_some_and(|cell| *cell != Value::Missing)
        }
        (Arrival::Message { topic, .. }, _) => topics.contains(topic),
        _ => false,
    };
    let mut before = t0;
    let heard: Vec<Time> = piece.samples.iter().filter(|(_, a)| heard(a)).map(|(time, _)| *time).collect();
    for time in heard.into_iter().chain([piece.last]) {
        if time.since(before) > limit {
            return true;
        }
        before = time;
    }
    false
}
