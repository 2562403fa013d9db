//! What is drawn on the screen: properties, topics, and what happened last.

use std::collections::VecDeque;

use lapwing::live::{PropertyView, StateNow, TopicView, View};
use lapwing_react::Role;
use lapwing_react::shown::{cell, seconds};
use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Color, Modifier, Style};
use ratatui::text::{Line, Span};
use ratatui::widgets::{Block, Borders, Cell, Paragraph, Row, Table};

/// The width of the bar of a margin, in characters.
const BAR: usize = 10;

/// So many values of a property are shown.
const VALUES: usize = 3;

/// Draws how things stand.
pub fn draw(frame: &mut Frame<'_>, view: &View, lines: &VecDeque<String>) {
    let properties = rows(view.properties.len());
    let topics = rows(view.topics.len());
    let parts = [Constraint::Length(1), Constraint::Length(properties), Constraint::Length(topics), Constraint::Min(3)];
    let [head, of_properties, of_topics, of_lines] = Layout::vertical(parts).areas(frame.area());
    frame.render_widget(heading(view), head);
    frame.render_widget(properties_table(view), of_properties);
    frame.render_widget(topics_table(view), of_topics);
    frame.render_widget(latest(lines, of_lines), of_lines);
}

/// The height of a table with so many rows: its border and its heading are three lines.
fn rows(count: usize) -> u16 {
    u16::try_from(count.clamp(1, 12) + 3).unwrap_or(u16::MAX)
}

fn heading(view: &View) -> Paragraph<'static> {
    let ran = seconds((i128::from(view.now.0) - i128::from(view.began.0)) / 100_000_000 * 100_000_000);
    let count = |state| view.properties.iter().filter(|p| p.state == state).count();
    let mut parts = vec![Span::styled(" lapwing ", Style::new().add_modifier(Modifier::REVERSED)), Span::raw(" ")];
    parts.push(Span::raw(format!("{}, for {ran}  ", view.source)));
    for state in [StateNow::Violated, StateNow::Blind, StateNow::Waiting, StateNow::Good] {
        if count(state) > 0 {
            parts.push(Span::styled(format!("{} {}  ", count(state), state.word()), style(state)));
        }
    }
    parts.push(Span::raw("q ends"));
    Paragraph::new(Line::from(parts))
}

fn properties_table(view: &View) -> Table<'static> {
    let most =
        view.properties.iter().filter_map(|p| p.margin).filter(|m| m.is_finite()).map(f64::abs).fold(0.0, f64::max);
    let rows = view.properties.iter().map(|property| {
        let what = property.cause.clone().unwrap_or_else(|| values(property));
        let times = if property.violations > 0 { property.violations.to_string() } else { String::new() };
        Row::new([
            Cell::from(property.state.word()).style(style(property.state)),
            Cell::from(property.name.clone()),
            Cell::from(times),
            Cell::from(property.margin.map_or_else(String::new, |margin| bar(margin, most))),
            Cell::from(what),
        ])
    });
    let widths = [
        Constraint::Length(9),
        Constraint::Max(30),
        Constraint::Length(6),
        Constraint::Length(22),
        Constraint::Min(10),
    ];
    let head =
        Row::new(["state", "property", "times", "margin", "now"]).style(Style::new().add_modifier(Modifier::DIM));
    Table::new(rows, widths).header(head).block(block("properties"))
}

fn topics_table(view: &View) -> Table<'static> {
    let rows = view.topics.iter().map(|topic: &TopicView| {
        let (what, colour) = match topic.causes.is_empty() {
            true => (topic.type_name.clone().unwrap_or_default(), Style::new()),
            false => (topic.causes.join("; "), style(StateNow::Blind)),
        };
        Row::new([
            Cell::from(topic.name.clone()),
            Cell::from(format!("{:.1} Hz", topic.rate)),
            Cell::from(topic.messages.to_string()),
            Cell::from(topic.publishers.to_string()),
            Cell::from(what).style(colour),
        ])
    });
    let widths = [
        Constraint::Max(32),
        Constraint::Length(12),
        Constraint::Length(12),
        Constraint::Length(10),
        Constraint::Min(10),
    ];
    let head = ["topic", "rate", "messages", "publishers", "type, or why it cannot be seen"];
    let head = Row::new(head).style(Style::new().add_modifier(Modifier::DIM));
    Table::new(rows, widths).header(head).block(block("topics"))
}

fn latest(lines: &VecDeque<String>, area: Rect) -> Paragraph<'static> {
    let fit = usize::from(area.height.saturating_sub(2));
    let shown = lines.iter().rev().take(fit).rev().map(|line| Line::from(plain(line)));
    Paragraph::new(shown.collect::<Vec<_>>()).block(block("what happened"))
}

fn block(title: &'static str) -> Block<'static> {
    Block::new().borders(Borders::ALL).title(title)
}

fn style(state: StateNow) -> Style {
    match state {
        StateNow::Violated => Style::new().fg(Color::Red).add_modifier(Modifier::BOLD),
        StateNow::Blind => Style::new().fg(Color::Yellow),
        StateNow::Waiting => Style::new().fg(Color::DarkGray),
        StateNow::Good => Style::new().fg(Color::Green),
    }
}

fn values(property: &PropertyView) -> String {
    let shown = property.values.iter().filter(|r| r.role == Role::Value).take(VALUES);
    shown.map(|r| format!("{} = {}", r.name, cell(&r.value))).collect::<Vec<_>>().join(", ")
}

/// A margin as a bar, of which the longest is the greatest margin of all: `███░░░░░░░ 0.31`.
fn bar(margin: f64, most: f64) -> String {
    if !margin.is_finite() || most <= 0.0 {
        return margin.to_string();
    }
    let filled = (margin.abs() / most * BAR as f64).round() as usize;
    let (full, empty) = ("█".repeat(filled.min(BAR)), "░".repeat(BAR - filled.min(BAR)));
    format!("{full}{empty} {margin:.3}")
}

/// A line without what colours it.
fn plain(line: &str) -> String {
    let mut parts = line.split("\x1b[");
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |text, part| text + part.split_once('m').map_or(part, |(_, rest)| rest))
}

#[cfg(test)]
mod tests {
    use lapwing_stream::Time;
    use ratatui::Terminal;
    use ratatui::backend::TestBackend;

    use super::*;

    fn property(name: &str, state: StateNow) -> PropertyView {
        PropertyView {
            name: name.to_owned(),
            file: "a.rv".to_owned(),
            line: 1,
            text: String::new(),
            state,
            cause: (state == StateNow::Blind).then(|| "/scan: nobody publishes it".to_owned()),
            violations: u64::from(state == StateNow::Violated) * 3,
            latest: None,
            margin: (state != StateNow::Blind).then_some(if state == StateNow::Good { 0.5 } else { -1.0 }),
            values: Vec::new(),
            failed: 0,
            instants: 0,
            lanes: Vec::new(),
            plots: Vec::new(),
            diagram: None,
        }
    }

    fn drawn(view: &View, lines: &[&str]) -> String {
        let mut terminal = Terminal::new(TestBackend::new(100, 20)).unwrap();
        let lines = lines.iter().map(|line| line.to_string()).collect();
        terminal.draw(|frame| draw(frame, view, &lines)).unwrap();
        let buffer = terminal.backend().buffer().clone();
        buffer.content.chunks(100).map(|row| row.iter().map(|c| c.symbol()).collect::<String>() + "\n").collect()
    }

    #[test]
    fn a_screen_shows_states_margins_rates_and_what_happened() {
        let view = View {
            source: "ROS 2, domain 7".to_owned(),
            now: Time(12_340_000_000),
            properties: vec![
                property("calm", StateNow::Good),
                property("fast", StateNow::Violated),
                property("clear", StateNow::Blind),
            ],
            topics: vec![TopicView {
                name: "/odom".to_owned(),
                rate: 29.97,
                messages: 370,
                publishers: 1,
                ..TopicView::default()
            }],
            ..View::default()
        };
        let text = drawn(&view, &["[1.5 s] \x1b[1;31mviolated\x1b[0m fast"]);
        for part in [
            "ROS 2, domain 7, for 12.3 s",
            "1 violated  1 blind  1 good",
            "█████░░░░░ 0.500",
            "██████████ -1.000",
            "/scan: nobody publishes it",
            "30.0 Hz",
            "[1.5 s] violated fast",
        ] {
            assert!(text.contains(part), "no `{part}` in\n{text}");
        }
    }

    #[test]
    fn nothing_at_all_can_be_drawn_too() {
        assert!(drawn(&View::default(), &[]).contains("properties"));
    }
}
