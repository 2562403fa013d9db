//! How things stand, in Prometheus' text format.

use std::fmt::Write;

use lapwing::live::{Latency, StateNow, View};

/// All metrics.
pub fn text(view: &View) -> String {
    let mut out = Metrics::default();
    let property = |p: &lapwing::live::PropertyView| vec![("property", p.name.clone()), ("file", p.file.clone())];
    out.head("lapwing_property_state", "gauge", "How a property stands: 0 good, 1 waiting, 2 blind, 3 violated.");
    for p in &view.properties {
        let state = match p.state {
            StateNow::Good => 0.0,
            StateNow::Waiting => 1.0,
            StateNow::Blind => 2.0,
            StateNow::Violated => 3.0,
        };
        out.value("lapwing_property_state", &property(p), state);
    }
    out.head("lapwing_violations_total", "counter", "Episodes of failures of a property.");
    view.properties.iter().for_each(|p| out.value("lapwing_violations_total", &property(p), p.violations as f64));
    out.head("lapwing_margin", "gauge", "The worst margin of a property so far, where margins are computed.");
    for p in &view.properties {
        if let Some(margin) = p.margin {
            out.value("lapwing_margin", &property(p), margin);
        }
    }
    let topic = |t: &lapwing::live::TopicView| vec![("topic", t.name.clone())];
    out.head("lapwing_topic_messages_total", "counter", "Messages of a topic.");
    view.topics.iter().for_each(|t| out.value("lapwing_topic_messages_total", &topic(t), t.messages as f64));
    out.head("lapwing_topic_publishers", "gauge", "Publishers of a topic.");
    view.topics.iter().for_each(|t| out.value("lapwing_topic_publishers", &topic(t), t.publishers as f64));
    out.head("lapwing_topic_blind", "gauge", "Whether a topic cannot be seen now.");
    view.topics
        .iter()
        .for_each(|t| out.value("lapwing_topic_blind", &topic(t), if t.causes.is_empty() { 0.0 } else { 1.0 }));
    out.head("lapwing_messages_lost_total", "counter", "Messages that were lost before they could be judged.");
    out.value("lapwing_messages_lost_total", &[], view.figures.lost as f64);
    out.histogram(
        "lapwing_verdict_latency_seconds",
        "From the arrival of a message to all that it decides.",
        &view.figures.judged,
    );
    out.histogram(
        "lapwing_reaction_latency_seconds",
        "From the arrival of a message to a reaction.",
        &view.figures.reacted,
    );
    out.histogram("lapwing_guard_delay_seconds", "How long guarded messages are held up.", &view.figures.guarded);
    out.text
}

#[derive(Default)]
struct Metrics {
    text: String,
}

impl Metrics {
    fn head(&mut self, name: &str, kind: &str, help: &str) {
        let _ = writeln!(self.text, "# HELP {name} {help}\n# TYPE {name} {kind}");
    }

    fn value(&mut self, name: &str, labels: &[(&str, String)], value: f64) {
        let labels: Vec<String> = labels.iter().map(|(key, value)| format!("{key}=\"{}\"", escaped(value))).collect();
        let labels = if labels.is_empty() { String::new() } else { format!("{{{}}}", labels.join(",")) };
        let _ = writeln!(self.text, "{name}{labels} {}", number(value));
    }

    fn histogram(&mut self, name: &str, help: &str, of: &Latency) {
        self.head(name, "histogram", help);
        let bucket = format!("{name}_bucket");
        for (upper, count) in of.cumulative() {
            self.value(&bucket, &[("le", number(upper.as_secs_f64()))], count as f64);
        }
        self.value(&bucket, &[("le", "+Inf".to_owned())], of.count() as f64);
        self.value(&format!("{name}_sum"), &[], of.sum().as_secs_f64());
        self.value(&format!("{name}_count"), &[], of.count() as f64);
    }
}

/// The value of a label: names of properties may hold anything.
fn escaped(text: &str) -> String {
    text.replace('\\', "\\\\").replace('"', "\\\"").replace('\n', "\\n")
}

fn number(x: f64) -> String {
    match x {
        f64::INFINITY => "+Inf".to_owned(),
        f64::NEG_INFINITY => "-Inf".to_owned(),
        x => x.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use lapwing::live::Figures;

    use super::*;

    #[test]
    fn names_are_escaped_and_histograms_add_up() {
        assert_eq!(escaped("a\"b\\c\nd"), "a\\\"b\\\\c\\nd");
        let mut figures = Figures::default();
        (1..=4).for_each(|n| figures.judged.note(Duration::from_micros(n)));
        let text = text(&View { figures, ..View::default() });
        assert!(text.contains("lapwing_verdict_latency_seconds_bucket{le=\"+Inf\"} 4\n"), "{text}");
        assert!(text.contains("lapwing_verdict_latency_seconds_bucket{le=\"0.000001\"} 1\n"), "{text}");
        assert!(text.contains("lapwing_verdict_latency_seconds_count 4\n"), "{text}");
        assert!(text.lines().all(|line| line.starts_with('#') || line.split(' ').count() == 2), "{text}");
    }
}
