//! The tables of the README, and the words in which a match is told.

use std::fmt::Write as _;

use super::thesis::REASONS;
use super::{Column, Compared, Results};
use crate::fault::Fault;
use crate::game::Account;
use crate::watch::Happening;

/// Both tables, with the reasons between them.
pub fn tables(results: &Results) -> String {
    let mut text = String::from(
        "| figure | property | fault | printed | here | violated at | goal | |\n| --- | --- | --- | --- | --- | --- | --- | --- |\n",
    );
    for compared in &results.figures {
        row(&mut text, compared, "", &compared.without);
        row(&mut text, compared, compared.figure.fault.name(), &compared.with);
    }
    text.push('\n');
    for reason in REASONS {
        // Writing to a text does not fail.
        let _ = writeln!(text, "- **{}** {}", reason.letter, reason.text);
    }
    text.push('\n');
    matrix(&mut text, results);
    text
}

fn row(text: &mut String, compared: &Compared, fault: &str, column: &Column) {
    let figure = compared.figure;
    let printed = drawn_together(column.printed.iter().map(String::as_str), figure.property);
    let ours = drawn_together(column.ours.iter().map(|h| h.name.as_str()), figure.property);
    let violation = format!("!{}", figure.property);
    let first = column.ours.iter().find(|h| h.name == violation).map(|h| seconds(h.time)).unwrap_or_default();
    let mut letters: Vec<String> = column.reasons.iter().map(|r| r.letter.to_string()).collect();
    letters.insert(0, if column.same { "same" } else { "differs" }.to_owned());
    let fault = if fault.is_empty() { String::new() } else { format!("`{fault}`") };
    let goal = if column.goal { "yes" } else { "**no**" };
    let _ = writeln!(
        text,
        "| {} | {} | {fault} | {printed} | {ours} | {first} | {goal} | {} |",
        figure.number,
        figure.property,
        letters.join(", ")
    );
}

/// At most so many different things in a row: no figure has more.
const SHOWN: usize = 16;

/// A sequence in which what repeats is counted, and which ends with an ellipsis where it is long.
fn drawn_together<'n>(names: impl Iterator<Item = &'n str>, property: &str) -> String {
    let mut drawn: Vec<(String, usize)> = Vec::new();
    for name in names {
        let name = thesis_name(name, property);
        match drawn.last_mut() {
            Some((last, count)) if *last == name => *count += 1,
            _ => drawn.push((name, 1)),
        }
    }
    let one = |(name, count): &(String, usize)| if *count > 1 { format!("{name} ×{count}") } else { name.clone() };
    let mut words: Vec<String> = drawn.iter().take(SHOWN).map(one).collect();
    if drawn.len() > SHOWN {
        words.push("…".to_owned());
    }
    words.join(", ")
}

/// What the thesis calls an event.
fn thesis_name(name: &str, property: &str) -> String {
    match name {
        "entered(soccer.turn_to_ball)" => "turn_to_ball_state_true".to_owned(),
        "entered(soccer.turn_to_goal)" => "turn_to_goal_state_true".to_owned(),
        "entered(soccer.dribble_to_goal)" => "dribble_ball_state_true".to_owned(),
        "entered(soccer.kick_ball_to_goal)" => "kick_ball_state_true".to_owned(),
        "!" => "**violated**".to_owned(),
        name if name.strip_prefix('!') == Some(property) => "**violated**".to_owned(),
        name => name.to_owned(),
    }
}

/// Which fault violates what, and when first.
fn matrix(text: &mut String, results: &Results) {
    let names = |account: &Account| account.judged.iter().map(|j| j.name.clone()).collect::<Vec<_>>();
    let columns = results.matches.first().map(|m| names(&m.account)).unwrap_or_default();
    let _ = writeln!(text, "| fault | {} | goal | over at |", columns.join(" | "));
    let _ = writeln!(text, "| --- |{} --- | --- |", " --- |".repeat(columns.len()));
    for played in &results.matches {
        let account = &played.account;
        let fault = played.fault.map_or("none".to_owned(), |f: Fault| format!("`{f}`"));
        let cell = |judged: &crate::watch::Judged| match judged.failed.first() {
            Some(first) => format!("**{}** {}", judged.verdict, seconds(*first)),
            None => judged.verdict.clone(),
        };
        let cells: Vec<String> = account.judged.iter().map(cell).collect();
        let goal = if account.goal { "yes" } else { "**no**" };
        let over = account.happenings.iter().rev().find(|h| h.name == "game_over").map(|h| seconds(h.time));
        let _ = writeln!(text, "| {fault} | {} | {goal} | {} |", cells.join(" | "), over.unwrap_or_default());
    }
}

fn seconds(nanos: i64) -> String {
    format!("{:.2} s", nanos as f64 / 1e9)
}

/// A match in words: what happened, repetitions drawn together, and what became of the properties.
pub fn told(account: &Account) -> String {
    let mut text = String::new();
    let mut last: Option<(&Happening, usize)> = None;
    let line = |(happening, count): (&Happening, usize)| {
        let times = if count > 1 { format!(" ×{count}") } else { String::new() };
        format!("{:>10}  {}{times}\n", seconds(happening.time), happening.name)
    };
    // The readings of the seeker would drown everything else.
    for happening in account.happenings.iter().filter(|h| h.name != "ir_read_true") {
        last = match last {
            Some((first, count)) if first.name == happening.name => Some((first, count + 1)),
            before => {
                before.into_iter().for_each(|run| text.push_str(&line(run)));
                Some((happening, 1))
            }
        };
    }
    last.into_iter().for_each(|run| text.push_str(&line(run)));
    text.push('\n');
    for judged in &account.judged {
        let failed: Vec<String> = judged.failed.iter().map(|&f| seconds(f)).collect();
        let at = if failed.is_empty() { String::new() } else { format!("  at {}", failed.join(", ")) };
        let _ = writeln!(text, "  {:<13}{}{at}", judged.verdict, judged.name);
    }
    let _ = writeln!(text, "\nThe ball is {}in the goal.", if account.goal { "" } else { "not " });
    text
}
