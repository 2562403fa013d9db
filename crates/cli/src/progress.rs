//! Progress bars, on a terminal only.

use std::io::IsTerminal;
use std::path::Path;

use indicatif::{MultiProgress, ProgressBar, ProgressDrawTarget, ProgressStyle};

/// The bars of several recordings; they draw nothing where nobody would see them.
pub fn bars(wanted: bool) -> MultiProgress {
    let visible = wanted && std::io::stderr().is_terminal();
    MultiProgress::with_draw_target(if visible { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() })
}

/// The bar of one recording.
pub fn bar(bars: &MultiProgress, trace: &Path) -> ProgressBar {
    let bar = bars.add(ProgressBar::no_length());
    if let Ok(style) = ProgressStyle::with_template("{msg} {wide_bar} {percent:>3} % {eta}") {
        bar.set_style(style);
    }
    bar.set_message(trace.file_name().unwrap_or(trace.as_os_str()).to_string_lossy().into_owned());
    bar
}
