//! Looks on while a graph is watched, and says what is to be said, where it is to be said.

use std::io::{self, Write};
use std::path::PathBuf;
use std::time::Duration;

use lapwing::live::{Onlooker, View};
use lapwing::{Report, Spec, Watch};
use lapwing_diag::Style;
use lapwing_react::{Event, Format, Standing, line, render};
use lapwing_stream::Time;

use super::audience::Audience;
use super::lines::Lines;
use super::screen::Screen;
use super::signals::Signals;
use crate::complain::say;
use crate::{interrupt, words};

/// So often a screen or a page gets a new view.
const PAUSE: Duration = Duration::from_millis(250);

/// Looks on.
pub struct Looker {
    format: Format,
    quiet: bool,
    /// Of stdout and of stderr.
    styles: (Style, Style),
    lines: Lines,
    screen: Option<Screen>,
    wants_screen: bool,
    audiences: Vec<Box<dyn Audience>>,
    signals: Signals,
    texts: Texts,
    source: String,
    /// Whether nobody reads what is written.
    closed: bool,
}

/// What the specifications are read from, and read from again.
pub struct Texts {
    /// Their files.
    pub paths: Vec<PathBuf>,
    /// Share trees with the definitions of messages that they write.
    pub msgs: Vec<PathBuf>,
}

impl Looker {
    /// Looks on, on a screen or by lines.
    pub fn new(
        format: Format,
        quiet: bool,
        styles: (Style, Style),
        wants_screen: bool,
        signals: Signals,
        texts: Texts,
    ) -> Looker {
        Looker {
            format,
            quiet,
            styles,
            lines: Lines::new(Time(0), styles.0),
            screen: None,
            wants_screen,
            audiences: Vec::new(),
            signals,
            texts,
            source: String::new(),
            closed: false,
        }
    }

    /// What happens is shown to them as well.
    pub fn show_to(&mut self, audiences: Vec<Box<dyn Audience>>) {
        self.audiences = audiences;
    }

    /// The terminal is a terminal again.
    pub fn close_screen(&mut self) {
        self.screen = None;
    }

    /// The report of a run.
    pub fn report(&mut self, report: &Report) {
        let is_left_out = self.quiet && self.format == Format::Text && report.standing() == Standing::Good;
        if !is_left_out {
            let gap = if self.format == Format::Text { "\n" } else { "" };
            let text = render(report, self.format, self.styles.0);
            self.out(&format!("{gap}{text}"));
        }
    }

    /// Writes to stdout. Where nobody reads any more, as behind `head`, the run ends.
    pub fn out(&mut self, text: &str) {
        if self.closed || text.is_empty() {
            return;
        }
        let mut stdout = io::stdout().lock();
        if let Err(error) = stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
            self.closed = true;
            interrupt::stop();
            if error.kind() != io::ErrorKind::BrokenPipe {
                say(&format!("error: what happens cannot be written: {error}\n"));
            }
        }
    }

    /// A line about what happened, where lines go.
    fn line(&mut self, text: &str, is_bad: bool) {
        match (&mut self.screen, self.format) {
            (Some(screen), _) => screen.line(text),
            (None, Format::Text) if is_bad || !self.quiet => self.out(text),
            (None, Format::Json | Format::Junit) if !self.quiet => say(text),
            _ => {}
        }
    }
}

impl Watch for Looker {
    fn event(&mut self, event: Event<'_>) {
        if let Event::Start(report) = event {
            self.source.clone_from(&report.trace);
            self.audiences.iter_mut().for_each(|audience| audience.begin());
            if self.wants_screen && self.screen.is_none() {
                match Screen::open() {
                    Ok(screen) => self.screen = Some(screen),
                    Err(why) => say(&format!("no screen can be drawn: {why}\n")),
                }
            }
        }
        if self.format == Format::Ndjson || !self.audiences.is_empty() {
            let json = line(&self.source, event);
            self.audiences.iter_mut().for_each(|audience| audience.event(event, &json));
            if self.format == Format::Ndjson {
                self.out(&json);
            }
        }
        if let Some((text, is_bad)) = self.lines.of(event) {
            self.line(&text, is_bad);
        }
    }

    fn goes_on(&mut self) -> bool {
        let leaves = self.screen.as_mut().is_some_and(Screen::leaves);
        !leaves && !interrupt::is_stopped() && !self.signals.end()
    }
}

impl Onlooker for Looker {
    fn note(&mut self, text: &str) {
        match &mut self.screen {
            Some(screen) => screen.line(&format!("{text}\n")),
            None if self.quiet => {}
            None => say(&format!("{text}\n")),
        }
    }

    fn pause(&self) -> Option<Duration> {
        (self.screen.is_some() || !self.audiences.is_empty()).then_some(PAUSE)
    }

    fn draws(&self) -> bool {
        !self.audiences.is_empty()
    }

    fn begins(&mut self, at: Time) {
        self.lines = Lines::new(at, self.styles.0);
    }

    fn look(&mut self, view: &View) {
        self.audiences.iter_mut().for_each(|audience| audience.look(view));
        if let Some(screen) = &mut self.screen
            && let Err(why) = screen.draw(view)
        {
            self.screen = None;
            say(&format!("the screen cannot be drawn any more: {why}\n"));
        }
    }

    fn reloads(&mut self) -> Option<Vec<Spec>> {
        if !self.signals.reload() {
            return None;
        }
        match words::specs(&self.texts.paths, &self.texts.msgs, self.styles.1) {
            Ok(specs) => {
                self.note("the specifications were read again");
                Some(specs)
            }
            Err(complaint) => {
                match &mut self.screen {
                    Some(screen) => complaint.text().lines().for_each(|line| screen.line(line)),
                    None => complaint.tell(),
                }
                self.note("the specifications stay as they are: what was read again is wrong");
                None
            }
        }
    }
}
