//! The sequences of events that the thesis prints in its figures 4.10 to 4.15, and those that the robot gives here.
//!
//! Sequences are compared after repetitions are drawn together, and up to the first violation: what comes after it depends on how long the recovery
//! takes. Where they differ, the difference must be among those that [`thesis`] explains; what it explains must occur.

mod tables;
pub mod thesis;

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::process::Command;

use lapwing_check::checked::{self, EventSource};

use crate::fault::Fault;
use crate::game::Account;
use crate::watch::{DIAGRAM, Happening};
pub use tables::{tables, told};
use thesis::{FIGURES, Figure, Reason};

/// Who plays the matches: each in a process of its own.
#[derive(Clone, Debug)]
pub struct Player {
    program: PathBuf,
    seed: u64,
}

impl Player {
    /// A program whose `play` is that of this crate, and the seed that it plays with.
    pub fn new(program: PathBuf, seed: u64) -> Player {
        Player { program, seed }
    }

    /// Plays a match. With `only` violations of that property alone are answered, as in the thesis, which has one monitor at a time.
    pub fn play(&self, fault: Option<Fault>, only: Option<&str>) -> Result<Account, String> {
        let mut command = Command::new(&self.program);
        command.args(["play", "--json", "--seed", &self.seed.to_string()]);
        fault.into_iter().for_each(|fault| _ = command.args(["--fault", fault.name()]));
        only.into_iter().for_each(|only| _ = command.args(["--only", only]));
        let output = command.output().map_err(|e| format!("{}: {e}", self.program.display()))?;
        if !output.status.success() {
            return Err(String::from_utf8_lossy(&output.stderr).into_owned());
        }
        serde_json::from_slice(&output.stdout).map_err(|e| e.to_string())
    }
}

/// A figure beside what came out here: once without the fault, once with it.
#[derive(Clone, Debug)]
pub struct Compared {
    /// The figure.
    pub figure: &'static Figure,
    /// Without the fault.
    pub without: Column,
    /// With it.
    pub with: Column,
}

/// One column of a figure.
#[derive(Clone, Debug)]
pub struct Column {
    /// What the thesis prints, in italics what its monitor does not step on.
    pub printed: Vec<String>,
    /// What came out here.
    pub ours: Vec<Happening>,
    /// Whether the two are the same, as far as they are compared.
    pub same: bool,
    /// Why they differ; why the figure shows what its monitor does not see.
    pub reasons: Vec<&'static Reason>,
    /// Whether the ball is in the goal at the end.
    pub goal: bool,
}

/// A match with a fault, all violations answered, and one without.
#[derive(Clone, Debug)]
pub struct Match {
    /// What went wrong.
    pub fault: Option<Fault>,
    /// What came of it.
    pub account: Account,
}

/// Everything that is played.
#[derive(Clone, Debug)]
pub struct Results {
    /// The figures.
    pub figures: Vec<Compared>,
    /// One match for each fault, the first without.
    pub matches: Vec<Match>,
}

/// Plays everything and compares.
pub fn compare(spec: &checked::Spec, player: &Player) -> Result<Results, String> {
    let figures = FIGURES.iter().map(|figure| compare_figure(figure, spec, player)).collect::<Result<_, _>>()?;
    let faults = std::iter::once(None).chain(Fault::ALL.map(Some));
    let play = |fault| Ok(Match { fault, account: player.play(fault, None)? });
    Ok(Results { figures, matches: faults.map(play).collect::<Result<_, String>>()? })
}

fn compare_figure(figure: &'static Figure, spec: &checked::Spec, player: &Player) -> Result<Compared, String> {
    let steps = alphabet(spec, figure.property).ok_or_else(|| format!("no property {}", figure.property))?;
    let column = |fault, printed: &[&str], reasons| -> Result<Column, String> {
        let account = player.play(fault, Some(figure.property))?;
        Ok(column(printed, &account, &steps, figure.property, reasons))
    };
    Ok(Compared {
        figure,
        without: column(None, figure.without, figure.why_without)?,
        with: column(Some(figure.fault), figure.with, figure.why_with)?,
    })
}

fn column(
    printed: &[&str],
    account: &Account,
    steps: &BTreeSet<String>,
    property: &str,
    reasons: &'static [&'static Reason],
) -> Column {
    let violation = format!("!{property}");
    let is_step = |name: &str| name == violation || steps.contains(name);
    let is_compared = |name: &&&str| is_step(name) || **name == "!";
    let compared: Vec<String> = printed.iter().filter(is_compared).map(|n| (*n).into()).collect();
    let printed = printed.iter().map(|n| if is_compared(&n) { (*n).into() } else { format!("*{n}*") }).collect();
    let ours: Vec<Happening> = account.happenings.iter().filter(|h| is_step(&h.name)).cloned().collect();
    let names: Vec<String> = ours.iter().map(|h| if h.name == violation { "!" } else { &h.name }.to_owned()).collect();
    let same = to_first_violation(&compared) == to_first_violation(&names);
    Column { printed, ours, same, reasons: reasons.to_vec(), goal: account.goal }
}

/// The events that a property's monitor steps on, by their names.
fn alphabet(spec: &checked::Spec, property: &str) -> Option<BTreeSet<String>> {
    let events = spec.properties.iter().find(|p| p.name == property)?.alphabet.as_ref()?;
    let name = |&event: &usize| {
        let event = spec.events.get(event)?;
        match event.source {
            EventSource::Entered { machine, state } => {
                let state = &spec.machines.get(machine)?.states.get(state)?.name;
                Some(format!("entered({DIAGRAM}.{state})"))
            }
            _ => Some(event.name.clone()),
        }
    };
    events.iter().map(name).collect()
}

/// A sequence up to its first violation, repetitions drawn together.
fn to_first_violation(names: &[String]) -> Vec<&str> {
    let end = names.iter().position(|n| n == "!").map_or(names.len(), |at| at + 1);
    let mut drawn: Vec<&str> = names.iter().take(end).map(String::as_str).collect();
    drawn.dedup();
    drawn
}

/// What is wrong with a comparison: differences that nothing explains, and explanations of what is no difference.
pub fn surprises(results: &Results) -> Vec<String> {
    let mut wrong = Vec::new();
    for compared in &results.figures {
        for (what, column) in [("without", &compared.without), ("with", &compared.with)] {
            let explained = column.reasons.iter().any(|reason| reason.changes_sequence);
            if column.same == explained {
                let is = if column.same {
                    "the same, but a difference is explained"
                } else {
                    "another, and nothing says why"
                };
                wrong.push(format!("figure {} {what} violation: the sequence is {is}", compared.figure.number));
            }
            if !column.goal {
                wrong.push(format!("figure {} {what} violation: the ball is not in the goal", compared.figure.number));
            }
        }
    }
    for played in &results.matches {
        let name = played.fault.map_or("no fault", Fault::name);
        let failed = || played.account.judged.iter().filter(|j| j.verdict != "holds");
        match played.fault {
            None => wrong.extend(failed().map(|j| format!("the healthy robot: {} is {}", j.name, j.verdict))),
            Some(_) if failed().next().is_none() => wrong.push(format!("{name}: not caught")),
            Some(_) => {}
        }
        // Who believes to be in range where it is not kicks, believes to have scored, and cannot be told better: the handler asks the same robot.
        let can_score = played.fault != Some(Fault::KickOutOfRange);
        if played.account.goal != can_score {
            let is = if can_score { "not " } else { "" };
            wrong.push(format!("{name}: the ball is {is}in the goal"));
        }
    }
    wrong
}
