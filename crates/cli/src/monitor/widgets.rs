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

/// The lines of a table besides its rows.
const FRAME: usize = 3;

/// What happened has at least so many lines, on screens that are higher than what is small.
const LINES: u16 = 3;
const SMALL: u16 = 12;

/// On screens narrower than this a table has only what is most wanted.
const NARROW: u16 = 80;

/// So many values of a property are shown.
const VALUES: usize = 3;

/// Draws how things stand.
pub fn draw(frame: &mut Frame<'_>, view: &View, lines: &VecDeque<String>) {
    let heights = heights(frame.area().height, view.properties.len(), view.topics.len());
    let [head, of_properties, of_topics, of_lines] =
        Layout::vertical(heights.map(Constraint::Length)).areas(frame.area());
    frame.render_widget(heading(view), head);
    frame.render_widget(properties_table(view, of_properties), of_properties);
    frame.render_widget(topics_table(view, of_topics), of_topics);
    frame.render_widget(latest(lines, of_lines), of_lines);
}

/// The heights of the heading, of both tables, and of what happened. Where not all of it has room, properties come first: what is left out at once
/// is what happened, and then topics.
fn heights(of_all: u16, properties: usize, topics: usize) -> [u16; 4] {
    let left = of_all.saturating_sub(1);
    let (properties, topics) = (rows(properties), rows(topics));
    if properties + topics + LINES <= left {
        return [1, properties, topics, left - properties - topics];
    }
    let lines = if left >= SMALL { LINES } else { 0 };
    let topics = if left >= SMALL { topics.min(((left - lines) / 3).max(rows(1))) } else { 0 };
    let properties = properties.min(left - lines - topics);
    [1, properties, topics, left - properties - topics]
}

/// The height of a table with so many rows: its border and its heading are three lines.
fn rows(count: usize) -> u16 {
    u16::try_from(count.clamp(1, 12) + FRAME).unwrap_or(u16::MAX)
}

/// Constraints of columns of which the first has names: as wide as the longest, between bounds.
fn name_width<'a>(names: impl Iterator<Item = &'a str>) -> Constraint {
    let longest = names.map(|name| name.chars().count()).max().unwrap_or_default();
    Constraint::Length(u16::try_from(longest.clamp(8, 32)).unwrap_or(u16::MAX))
}

fn heading(view: &View) -> Paragraph<'static> {
    let ran = seconds((i128::from(view.now.0) - i128::from(view.began.0)) / 100_000_000 * 100_000_000);
    let count = |state| view.properties.iter().filter(|p| p.state == state).count();
    let mut parts = vec![Span::styled(" lapwing ", Style::new().add_modifier(Modifier::REVERSED)), Span::raw(" ")];
    parts.push(Span::raw(format!("{}, for {ran}  ", view.source)));
    for state in STATES {
        if count(state) > 0 {
            parts.push(Span::styled(format!("{} {}  ", count(state), state.word()), style(state)));
        }
    }
    parts.push(Span::raw("q ends"));
    Paragraph::new(Line::from(parts))
}

/// The properties, the worst first, for a screen may not have room for all.
fn properties_table(view: &View, area: Rect) -> Table<'static> {
    let most =
        view.properties.iter().filter_map(|p| p.margin).filter(|m| m.is_finite()).map(f64::abs).fold(0.0, f64::max);
    let mut properties: Vec<&PropertyView> = view.properties.iter().collect();
    properties.sort_by_key(|property| STATES.iter().position(|state| *state == property.state));
    let is_narrow = area.width < NARROW;
    let rows = properties.iter().map(|property| {
        let what = property.cause.clone().unwrap_or_else(|| values(property));
        let times = if property.violations > 0 { property.violations.to_string() } else { String::new() };
        let mut cells = vec![
            Cell::from(property.state.word()).style(style(property.state)),
            Cell::from(property.name.clone()),
            Cell::from(times),
            Cell::from(property.margin.map_or_else(String::new, |margin| bar(margin, most))),
            Cell::from(what),
        ];
        if is_narrow {
            cells.drain(2..4);
        }
        Row::new(cells)
    });
    let names = name_width(properties.iter().map(|property| property.name.as_str()));
    let mut widths =
        vec![Constraint::Length(9), names, Constraint::Length(6), Constraint::Length(22), Constraint::Min(10)];
    let mut head = vec!["state", "property", "times", "margin", "now"];
    if is_narrow {
        widths.drain(2..4);
        head.drain(2..4);
    }
    let head = Row::new(head).style(Style::new().add_modifier(Modifier::DIM));
    let fit = usize::from(area.height).saturating_sub(FRAME);
    let title = match properties.len() > fit {
        true => format!("properties: {fit} of {}, the worst first", properties.len()),
        false => "properties".to_owned(),
    };
    Table::new(rows, widths).header(head).block(block(title))
}

/// States, the worst first.
const STATES: [StateNow; 4] = [StateNow::Violated, StateNow::Blind, StateNow::Waiting, StateNow::Good];

fn topics_table(view: &View, area: Rect) -> Table<'static> {
    let is_narrow = area.width < NARROW;
    let rows = view.topics.iter().map(|topic: &TopicView| {
        let (what, colour) = match topic.causes.is_empty() {
            true => (topic.type_name.clone().unwrap_or_default(), Style::new()),
            false => (topic.causes.join("; "), style(StateNow::Blind)),
        };
        let mut cells = vec![
            Cell::from(topic.name.clone()),
            Cell::from(format!("{:.1} Hz", topic.rate)),
            Cell::from(topic.messages.to_string()),
            Cell::from(topic.publishers.to_string()),
            Cell::from(what).style(colour),
        ];
        if is_narrow {
            cells.drain(2..4);
        }
        Row::new(cells)
    });
    let names = name_width(view.topics.iter().map(|topic| topic.name.as_str()));
    let mut widths =
        vec![names, Constraint::Length(10), Constraint::Length(12), Constraint::Length(10), Constraint::Min(10)];
    let mut head = vec!["topic", "rate", "messages", "publishers", "type, or why it cannot be seen"];
    if is_narrow {
        widths.drain(2..4);
        head.drain(2..4);
    }
    let head = Row::new(head).style(Style::new().add_modifier(Modifier::DIM));
    Table::new(rows, widths).header(head).block(block("topics".to_owned()))
}

fn latest(lines: &VecDeque<String>, area: Rect) -> Paragraph<'static> {
    let fit = usize::from(area.height.saturating_sub(2));
    let shown = lines.iter().rev().take(fit).rev().map(|line| Line::from(plain(line)));
    Paragraph::new(shown.collect::<Vec<_>>()).block(block("what happened".to_owned()))
}

fn block(title: String) -> Block<'static> {
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
        drawn_on(100, 20, view, lines)
    }

    fn drawn_on(width: u16, height: u16, view: &View, lines: &[&str]) -> String {
        let mut terminal = Terminal::new(TestBackend::new(width, height)).unwrap();
        let lines = lines.iter().map(|line| line.to_string()).collect();
        terminal.draw(|frame| draw(frame, view, &lines)).unwrap();
        let buffer = terminal.backend().buffer().clone();
        buffer
            .content
            .chunks(width.into())
            .map(|row| row.iter().map(|c| c.symbol()).collect::<String>() + "\n")
            .collect()
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
    fn what_is_worst_is_shown_where_not_everything_has_room() {
        let mut properties: Vec<PropertyView> =
            (0..40).map(|k| property(&format!("good_{k}"), StateNow::Good)).collect();
        properties.push(property("fast", StateNow::Violated));
        let topics = vec![TopicView { name: "/odom".to_owned(), rate: 29.97, ..TopicView::default() }];
        let view = View { properties, topics, ..View::default() };
        let wide = drawn_on(100, 40, &view, &[]);
        assert!(wide.contains("properties: 12 of 41, the worst first") && wide.contains("fast"), "{wide}");
        let narrow = drawn_on(50, 14, &view, &["it moved"]);
        for part in ["violated  fast", "/odom", "30.0 Hz", "it moved"] {
            assert!(narrow.contains(part), "no `{part}` in\n{narrow}");
        }
        let tiny = drawn_on(24, 6, &view, &[]);
        assert!(tiny.contains("fast"), "{tiny}");
        drawn_on(1, 1, &view, &[]);
    }

    #[test]
    fn nothing_at_all_can_be_drawn_too() {
        assert!(drawn(&View::default(), &[]).contains("properties"));
    }
}
