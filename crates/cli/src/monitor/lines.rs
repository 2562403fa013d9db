//! What happens in a run, a line each.

use lapwing_diag::Style;
use lapwing_react::shown::{Origin, value};
use lapwing_react::{Event, Property, Report, Role, Violation, Warning};
use lapwing_stream::Time;

/// So many values are shown beside a violation.
const VALUES: usize = 4;

/// Makes lines of events.
#[derive(Clone, Debug)]
pub struct Lines {
    /// When the run began, by the wall clock.
    began: Time,
    style: Style,
}

impl Lines {
    /// Lines in a style, of a run that began then.
    pub fn new(began: Time, style: Style) -> Lines {
        Lines { began, style }
    }

    /// The line of what happened, and whether it is of something that is not well. Verdicts come at the end, in the report.
    pub fn of(&self, event: Event<'_>) -> Option<(String, bool)> {
        match event {
            Event::Start(report) => Some((start(report), false)),
            Event::Violation { property, violation } => Some((self.violation(property, violation), true)),
            Event::Warning(warning) => self.warning(warning).map(|line| (line, false)),
            Event::Verdict(_) | Event::End(_) => None,
        }
    }

    fn violation(&self, property: &Property, violation: &Violation) -> String {
        let text = property.text.split_whitespace().collect::<Vec<_>>().join(" ");
        let readings = violation.values.iter().flatten().filter(|r| r.role == Role::Value).take(VALUES);
        let values: Vec<String> = readings.map(|r| format!("{} = {}", r.name, value(&r.value))).collect();
        let values = if values.is_empty() { String::new() } else { format!("  ({})", values.join(", ")) };
        let began = match violation.began == violation.failed {
            true => String::new(),
            false => format!(", since {}", self.at(violation.began)),
        };
        // The text has the name of the property, and an instance's own beside it: `slow[r1]`.
        let named = format!("{}: ", property.name.split('[').next().unwrap_or_default());
        let text = text.strip_prefix(&named).unwrap_or(&text);
        let word = paint(self.style, "\x1b[1;31m", "violated");
        let at = self.at(violation.failed);
        format!("[{at}] {word} {}{began}: {text}{values}\n", property.name)
    }

    /// What has a place in a specification is shown there, on stderr.
    fn warning(&self, warning: &Warning) -> Option<String> {
        let word = paint(self.style, "\x1b[33m", "warning");
        match (&warning.place, warning.at) {
            (Some((file, line, _)), _) => Some(format!("{word} {file}:{line}: {}\n", warning.message)),
            (None, Some(at)) => Some(format!("[{}] {word} {}\n", self.at(at), warning.message)),
            (None, None) => Some(format!("{word} {}\n", warning.message)),
        }
    }

    /// A stamp; one that counts in a calendar is shown from the beginning of the run on.
    fn at(&self, time: Time) -> String {
        let report = Report { span: Some((time, time)), ..Report::default() };
        let is_of_a_calendar = Origin::of(&report) == Origin(time);
        if is_of_a_calendar { Origin(self.began).time(time) } else { Origin(Time(0)).time(time) }
    }
}

fn start(report: &Report) -> String {
    let names: Vec<&str> = report.topics.iter().map(|t| t.name.as_str()).collect();
    let topics = if names.is_empty() { "no topic yet".to_owned() } else { names.join(", ") };
    format!(
        "watching {}: {} of {}, reading {topics}\n",
        report.trace,
        properties(report.properties.len()),
        report.specs.join(", ")
    )
}

fn properties(count: usize) -> String {
    if count == 1 { "1 property".to_owned() } else { format!("{count} properties") }
}

fn paint(style: Style, colour: &str, word: &str) -> String {
    match style {
        Style::Colour => format!("{colour}{word}\x1b[0m"),
        Style::Plain => word.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use lapwing_react::Reading;
    use lapwing_stream::Value;

    use super::*;

    #[test]
    fn a_violation_is_one_line_with_its_values() {
        let lines = Lines::new(Time(1_760_000_000_000_000_000), Style::Plain);
        let property = Property::new("calm", "a.rv", (2, 1), "calm: never\n  speed > 2");
        let reading = Reading { name: "speed".to_owned(), value: Value::Num(3.0), role: Role::Value };
        let violation = Violation {
            began: Time(1_760_000_001_000_000_000),
            failed: Time(1_760_000_001_500_000_000),
            until: Time(1_760_000_001_500_000_000),
            count: 1,
            values: Some(vec![reading]),
            began_values: None,
            history: Vec::new(),
            why: None,
        };
        let (line, is_bad) = lines.of(Event::Violation { property: &property, violation: &violation }).unwrap();
        assert_eq!(line, "[1.5 s] violated calm, since 1 s: never speed > 2  (speed = 3)\n");
        assert!(is_bad);
        let of_an_instance = Property { name: "calm[r1]".to_owned(), ..property };
        let (line, _) = lines.of(Event::Violation { property: &of_an_instance, violation: &violation }).unwrap();
        assert_eq!(line, "[1.5 s] violated calm[r1], since 1 s: never speed > 2  (speed = 3)\n");
    }
}
