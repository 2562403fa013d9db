//! Source files and places in them.

/// A file of a [`SourceMap`].
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug, Default)]
pub struct FileId(pub u32);

/// A range of bytes in a source file: `start` is the first byte, `end` the first after it.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug, Default)]
pub struct Span {
    /// The file.
    pub file: FileId,
    /// The first byte.
    pub start: u32,
    /// The byte after the last.
    pub end: u32,
}

impl Span {
    /// The range `start..end` of `file`.
    pub fn new(file: FileId, start: usize, end: usize) -> Span {
        Span { file, start: start as u32, end: end as u32 }
    }

    /// The smallest span that covers both; both lie in one file.
    pub fn to(self, other: Span) -> Span {
        Span { file: self.file, start: self.start.min(other.start), end: self.end.max(other.end) }
    }
}

/// The texts that spans point into.
#[derive(Clone, Debug, Default)]
pub struct SourceMap {
    files: Vec<Source>,
}

#[derive(Clone, Debug)]
struct Source {
    name: String,
    text: String,
    /// The byte at which each line begins, in order; the first is 0.
    lines: Vec<u32>,
}

impl SourceMap {
    /// Adds a file under the name that reports will use.
    pub fn add(&mut self, name: impl Into<String>, text: impl Into<String>) -> FileId {
        let text = text.into();
        let begins = text.bytes().enumerate().filter(|(_, b)| *b == b'\n').map(|(at, _)| at as u32 + 1);
        let lines = std::iter::once(0).chain(begins).collect();
        self.files.push(Source { name: name.into(), text, lines });
        FileId(self.files.len() as u32 - 1)
    }

    /// The names and texts of all files, in the order in which they were added.
    pub fn files(&self) -> impl Iterator<Item = (&str, &str)> {
        self.files.iter().map(|f| (f.name.as_str(), f.text.as_str()))
    }

    /// The name a file was added under.
    pub fn name(&self, file: FileId) -> &str {
        self.files.get(file.0 as usize).map_or("?", |f| &f.name)
    }

    /// The whole text of a file.
    pub fn text(&self, file: FileId) -> &str {
        self.files.get(file.0 as usize).map_or("", |f| &f.text)
    }

    /// The text that a span covers.
    pub fn slice(&self, span: Span) -> &str {
        self.text(span.file).get(span.start as usize..span.end as usize).unwrap_or("")
    }

    /// Line and column, both from 1, of a span's first byte; columns count characters.
    pub fn position(&self, span: Span) -> (usize, usize) {
        let text = self.text(span.file);
        let start = text.floor_char_boundary(span.start as usize);
        let line = self.line(span.file, start);
        let begin = self.line_start(span.file, line);
        (line, text.get(begin..start).unwrap_or("").chars().count() + 1)
    }

    /// The number, from 1, of the line in which a byte stands.
    pub(crate) fn line(&self, file: FileId, byte: usize) -> usize {
        let lines = self.files.get(file.0 as usize).map_or(&[][..], |f| &f.lines);
        lines.partition_point(|&begin| begin as usize <= byte).max(1)
    }

    /// The first byte of a line, counted from 1; the length of the text where there are fewer lines.
    pub(crate) fn line_start(&self, file: FileId, line: usize) -> usize {
        let lines = self.files.get(file.0 as usize).map_or(&[][..], |f| &f.lines);
        lines.get(line.saturating_sub(1)).map_or(self.text(file).len(), |&begin| begin as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_count_lines_and_characters_from_one() {
        let mut sources = SourceMap::default();
        let file = sources.add("a.rv", "ab\né→x\n");
        let position = |start| sources.position(Span::new(file, start, start));
        assert_eq!([position(0), position(2), position(3)], [(1, 1), (1, 3), (2, 1)]);
        assert_eq!([position(5), position(8), position(9)], [(2, 2), (2, 3), (2, 4)]);
        assert_eq!(position(10), (3, 1), "behind the last newline");
        assert_eq!([position(4), position(99)], [(2, 1), (3, 1)], "inside a character, behind the end");
        assert_eq!(sources.position(Span::new(FileId(7), 3, 4)), (1, 1), "no such file");
    }
}
