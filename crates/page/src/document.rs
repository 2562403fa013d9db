//! The document: one recording as it is, several behind an index.

use std::io::{self, Write};

use crate::assets::{PLOTLY, SCRIPT, STYLE, policy};
use crate::html::text;
use crate::index;
use crate::run::Entry;

/// The most buckets, of up to four points, that a curve has where there are few recordings.
const MOST: usize = 4000;

/// So many buckets are shared out among the recordings.
const SHARED: usize = 40_000;

/// The fewest buckets that show how a curve went.
const FEWEST: usize = 50;

/// How many buckets of points to keep of each curve on a page with so many recordings, so that it does not grow with their number.
pub fn points(recordings: usize) -> usize {
    (SHARED / recordings.max(1)).clamp(FEWEST, MOST)
}

/// Writes the page.
pub fn write(to: &mut dyn Write, entries: &[Entry]) -> io::Result<()> {
    let title = match entries {
        [one] => one.title.clone(),
        several => format!("{} recordings", several.len()),
    };
    write!(
        to,
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"{}\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<meta name=\"color-scheme\" content=\"light dark\">\n\
         <meta name=\"generator\" content=\"Lapwing {}\">\n<title>{} - Lapwing</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n{TOP}<main id=\"main\">\n",
        policy(),
        env!("CARGO_PKG_VERSION"),
        text(&title),
    )?;
    body(to, entries)?;
    // Not `</main>` inside of the scripts: the charts are drawn once all that is to be read is there.
    write!(to, "</main>\n{FOOT}<script>{}</script>\n<script>{}</script>\n</body>\n</html>\n", *PLOTLY, *SCRIPT)
}

const TOP: &str = "<a class=\"skip\" href=\"#main\">To the report</a>\n<div class=\"top\"><p class=\"brand\">Lapwing</p>\
    <button type=\"button\" class=\"theme\" hidden></button></div>\n";

const FOOT: &str = "<footer><p>Made by Lapwing. Charts: plotly.js, © Plotly, Inc., MIT licence.</p></footer>\n";

fn body(to: &mut dyn Write, entries: &[Entry]) -> io::Result<()> {
    match entries {
        [one] => write!(to, "<article class=\"run\" data-run=\"0\">\n{}</article>\n", one.article)?,
        several => {
            write!(to, "{}", index::table(several))?;
            for (number, entry) in several.iter().enumerate() {
                write!(to, "<template data-run=\"{number}\">\n{}</template>\n", entry.article)?;
            }
        }
    }
    for (number, entry) in entries.iter().enumerate() {
        writeln!(to, "<script type=\"application/json\" id=\"data-{number}\">{}</script>", entry.data)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_recordings_share_what_there_is() {
        assert_eq!([1, 10, 100, 100_000].map(points), [4000, 4000, 400, 50]);
    }
}
