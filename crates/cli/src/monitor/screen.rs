//! A screen on a terminal: how things stand, drawn anew some times a second.

use std::collections::VecDeque;
use std::io;
use std::time::Duration;

use lapwing::live::View;
use ratatui::DefaultTerminal;
use ratatui::crossterm::event::{Event, KeyCode, KeyEventKind, KeyModifiers, poll, read};
use ratatui::crossterm::execute;
use ratatui::crossterm::terminal::{Clear, ClearType};

use super::widgets;

/// So many lines are kept; what does not fit on the screen is in the report.
const KEPT: usize = 200;

/// The screen. When it is dropped the terminal is as it was.
pub struct Screen {
    terminal: DefaultTerminal,
    lines: VecDeque<String>,
}

impl Screen {
    /// Takes the terminal over.
    pub fn open() -> io::Result<Screen> {
        let screen = Screen { terminal: ratatui::try_init()?, lines: VecDeque::new() };
        // Not every terminal has a second screen that is empty. `Terminal::clear` asks where the cursor is, and not every one answers.
        execute!(io::stdout(), Clear(ClearType::All))?;
        Ok(screen)
    }

    /// Something happened; it is shown with the next view.
    pub fn line(&mut self, text: &str) {
        if self.lines.len() >= KEPT {
            self.lines.pop_front();
        }
        self.lines.push_back(text.trim_end().to_owned());
    }

    /// Shows how things stand.
    pub fn draw(&mut self, view: &View) -> io::Result<()> {
        let lines = &self.lines;
        self.terminal.draw(|frame| widgets::draw(frame, view, lines)).map(drop)
    }

    /// Whether whoever looks on wants to leave: q, Escape or Ctrl-C, which is no signal while a screen is drawn.
    pub fn leaves(&mut self) -> bool {
        while poll(Duration::ZERO).unwrap_or(false) {
            let Ok(Event::Key(key)) = read() else { continue };
            let is_interrupt = key.code == KeyCode::Char('c') && key.modifiers.contains(KeyModifiers::CONTROL);
            if key.kind != KeyEventKind::Release
                && (is_interrupt || matches!(key.code, KeyCode::Char('q') | KeyCode::Esc))
            {
                return true;
            }
        }
        false
    }
}

impl Drop for Screen {
    fn drop(&mut self) {
        ratatui::restore();
    }
}
