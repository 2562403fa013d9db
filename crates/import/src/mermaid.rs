//! Mermaid's state diagrams, a line at a time.
//!
//! What `lapwing explain --format mermaid` draws is read back whole: each frame is a machine, and comments `%% lapwing: …` say what a drawing does not, in the
//! words of a machine. Anybody may write such comments into a diagram.

use std::collections::BTreeMap;
use std::ops::Range;

use lapwing_diag::{Code, Diagnostic};

use crate::Report;
use crate::chart::{
    self, Annotation, Arrow, Chart, Clauses, Kind, MOST_ARROWS, MOST_DEPTH, MOST_NODES, Place, Trigger, annotation,
    renamed,
};
use crate::names::slug;
use crate::sheet::Sheet;

/// What a comment for us begins with.
const MARK: &str = "lapwing:";

/// Lines that say how something looks.
const LOOKS: &[&str] = &[
    "direction",
    "hide",
    "scale",
    "classDef",
    "class",
    "style",
    "linkStyle",
    "click",
    "accTitle",
    "accDescr",
    "title",
];

/// Whether a text is a state diagram of Mermaid, whatever is wrong with it.
pub(crate) fn is_state_diagram(text: &str) -> bool {
    let mut skipping: Option<&str> = None;
    for line in text.lines().map(str::trim) {
        match (skipping, line) {
            (Some(end), line) if line.ends_with(end) => skipping = None,
            (Some(_), _) => {}
            (None, "---") => skipping = Some("---"),
            (None, line) if opens_directive(line) => skipping = Some(DIRECTIVE_END),
            (None, line) if line.is_empty() || line.starts_with("%%") => {}
            (None, line) => return line.starts_with("stateDiagram"),
        }
    }
    false
}

/// What ends a directive `%%{init: …}%%`.
const DIRECTIVE_END: &str = "}%%";

/// Whether a directive begins in this line and does not end in it.
fn opens_directive(line: &str) -> bool {
    line.starts_with("%%{") && !line.ends_with(DIRECTIVE_END)
}

/// A line without the comment behind it. A label goes on to the end of its line, signs of comments included.
fn uncommented(line: &str) -> &str {
    let is_said = |head: &str| head.replace(":::", "").contains(':') || head.contains('"');
    match line.split_once("%%") {
        Some((head, _)) if !is_said(head) => head.trim_end(),
        _ => line,
    }
}

/// Reads a diagram that begins at `base` in its file; `name` is what it is called where it does not say so.
pub(crate) fn read(text: &str, base: usize, name: &str, sheet: &mut Sheet, report: &mut Report) {
    let mut reader = Reader {
        chart: Chart::new(name, false),
        known: BTreeMap::new(),
        scopes: vec![Scope { node: 0, region: None }],
        labels: Vec::new(),
        annotated: Vec::new(),
        report,
        base,
        failed: false,
    };
    reader.lines(text);
    reader.close(text.len());
    if reader.failed {
        return;
    }
    reader.annotate();
    if reader.failed {
        return;
    }
    reader.name_states();
    reader.read_labels();
    let chart = reader.chart;
    if chart.nodes.len() == 1 {
        let span = report.span(base, base + text.len());
        report.push(Diagnostic::new(Code::ImportSyntax, span, "the state diagram has no states"));
        return;
    }
    chart::write(&chart, sheet, report);
}

/// An open brace.
struct Scope {
    node: usize,
    /// The region that is being read, where there are several.
    region: Option<usize>,
}

impl Scope {
    fn inner(&self) -> usize {
        self.region.unwrap_or(self.node)
    }
}

struct Reader<'r> {
    chart: Chart,
    /// Nodes by their names.
    known: BTreeMap<String, usize>,
    scopes: Vec<Scope>,
    /// The label of each arrow, with its place in the file.
    labels: Vec<(String, usize)>,
    /// What comments say of states: around the comment, the name of the state, what it says.
    annotated: Vec<(usize, String, Clauses, Range<usize>)>,
    report: &'r mut Report,
    base: usize,
    failed: bool,
}

impl Reader<'_> {
    fn wrong(&mut self, place: Range<usize>, code: Code, message: impl Into<String>) {
        self.failed |= code != Code::ImportDiffers;
        let span = self.report.span(place.start, place.end);
        self.report.push(Diagnostic::new(code, span, message));
    }

    fn lines(&mut self, text: &str) {
        let mut at = 0;
        // What ends that which is passed over, and where it began.
        let mut skipping: Option<(&str, Range<usize>)> = None;
        let mut begun = false;
        for (number, whole) in text.split_inclusive('\n').enumerate() {
            let line = whole.trim();
            let start = self.base + at + (whole.len() - whole.trim_start().len());
            at += whole.len();
            let place = start..start + line.len();
            if let Some((end, _)) = skipping {
                let title = line.strip_prefix("title:").filter(|_| end == "---");
                title.into_iter().for_each(|t| self.chart.name = t.trim().trim_matches('"').to_owned());
                if line == end || end == DIRECTIVE_END && line.ends_with(end) {
                    skipping = None;
                }
            } else if line == "---" && number == 0 {
                skipping = Some(("---", place));
            } else if opens_directive(line) {
                skipping = Some((DIRECTIVE_END, place));
            } else if let Some(comment) = line.strip_prefix("%%") {
                self.comment(comment.trim(), place);
            } else if line.is_empty() {
            } else if !begun {
                if !line.starts_with("stateDiagram") {
                    return self.wrong(
                        place,
                        Code::ImportSyntax,
                        "expected `stateDiagram-v2`, as the first word of a state diagram",
                    );
                }
                begun = true;
            } else if line.starts_with("note ") && !line.contains([':', '"']) {
                skipping = Some(("end note", place));
            } else if line.starts_with("accDescr") && line.ends_with('{') {
                skipping = Some(("}", place));
            } else {
                self.line(uncommented(line).trim_end_matches(';').trim_end(), place);
            }
            if !self.is_within_limits(start) {
                return;
            }
        }
        if let Some((end, place)) = skipping {
            return self.wrong(place, Code::ImportSyntax, format!("no `{end}` ends what begins here"));
        }
        if !begun {
            self.wrong(
                self.base..self.base,
                Code::ImportSyntax,
                "there is no state diagram: it begins with `stateDiagram-v2`",
            );
        }
    }

    /// Whether there are no more states, arrows and comments on states than are read; it is told, at a place in the file, where there are.
    fn is_within_limits(&mut self, at: usize) -> bool {
        let states = self.chart.nodes.len().max(self.annotated.len());
        let within = states <= MOST_NODES && self.chart.arrows.len() <= MOST_ARROWS;
        if !within {
            let message = format!("the diagram has more than {MOST_NODES} states or {MOST_ARROWS} arrows");
            self.wrong(at..at, Code::ImportRefused, message);
        }
        within
    }

    /// `%% lapwing: state turn when …`
    fn comment(&mut self, comment: &str, place: Range<usize>) {
        let Some(entry) = comment.strip_prefix(MARK).map(str::trim) else { return };
        let scope = self.inner();
        let Some(node) = self.chart.nodes.get_mut(scope) else { return };
        let machine = node.annotation.get_or_insert_with(Annotation::default);
        if entry.starts_with("machine ") {
            return;
        }
        match annotation(entry) {
            Some((state, sample, else_stay)) => {
                machine.take(sample, else_stay);
                self.annotated.extend(state.map(|(name, clauses)| (scope, name, clauses, place)));
            }
            None => {
                let message = format!("`{entry}` is no entry of a machine");
                self.wrong(place, Code::ImportSyntax, message);
            }
        }
    }

    /// Gives states what comments say of them. The order of the comments is the order in which their conditions are tried.
    fn annotate(&mut self) {
        let mut ranked: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (scope, name, clauses, place) in std::mem::take(&mut self.annotated) {
            let named = |n: &usize| self.chart.nodes[*n].id == name && *n != scope && self.chart.is_in(*n, scope);
            let found = (0..self.chart.nodes.len()).find(named);
            // A state to which no arrow leads may stand in a comment alone.
            let at = place.start;
            let node = found.unwrap_or_else(|| self.chart.add(&name, Kind::State, scope, place));
            if !self.is_within_limits(at) {
                return;
            }
            self.chart.nodes[node].own =
                Clauses { bounds: [&self.chart.nodes[node].own.bounds[..], &clauses.bounds].concat(), ..clauses };
            ranked.entry(scope).or_default().push(node);
        }
        for nodes in ranked.into_values() {
            let mut ranks: Vec<usize> = nodes.iter().map(|n| self.chart.nodes[*n].rank).collect();
            ranks.sort_unstable();
            nodes.into_iter().zip(ranks).for_each(|(node, rank)| self.chart.nodes[node].rank = rank);
        }
    }

    fn inner(&self) -> usize {
        self.scopes.last().map_or(0, Scope::inner)
    }

    fn line(&mut self, line: &str, place: Range<usize>) {
        let first = line.split([' ', ':', '\t']).next().unwrap_or("");
        if line == "}" {
            self.close_one(place);
        } else if line == "--" {
            self.next_region(place);
        } else if line.contains("-->") {
            self.arrow(line, place);
        } else if first == "state" && line.len() > 5 {
            self.state(line.get(5..).unwrap_or("").trim(), place);
        } else if LOOKS.contains(&first) || first == "note" {
        } else if let Some((id, description)) = line.split_once(':') {
            let id = plain(id);
            if self.is_id(id, &place) {
                self.described(id, description.trim_start_matches(':'), place);
            }
        } else if self.is_id(line, &place) {
            self.node(line, place);
        }
    }

    fn is_id(&mut self, id: &str, place: &Range<usize>) -> bool {
        let is = !id.is_empty() && !id.contains(char::is_whitespace) && !id.contains(['{', '}', '"', '>']);
        if !is {
            self.wrong(place.clone(), Code::ImportSyntax, "expected a state, an arrow `a --> b`, or `state …`");
        }
        is
    }

    /// The node of that name, made where there is none.
    fn node(&mut self, id: &str, place: Range<usize>) -> usize {
        if let Some(&known) = self.known.get(id) {
            return known;
        }
        let node = self.chart.add(id, Kind::State, self.inner(), place);
        self.known.insert(id.to_owned(), node);
        node
    }

    /// `a --> b : label`
    fn arrow(&mut self, line: &str, place: Range<usize>) {
        let Some((from, rest)) = line.split_once("-->") else { return };
        let (to, label) = rest.split_once(':').unwrap_or((rest, ""));
        // `b:::class` says how it looks.
        let (to, label) = match label.strip_prefix("::") {
            Some(rest) => (to, rest.split_once(':').map_or("", |(_, label)| label)),
            None => (to, label),
        };
        let (from, to) = (plain(from), plain(to));
        if !self.is_id(from, &place) || !self.is_id(to, &place) {
            return;
        }
        let scope = self.inner();
        if from == "[*]" {
            let target = self.node(to, place);
            if let Some(node) = self.chart.nodes.get_mut(scope) {
                node.initial = node.initial.or(Some(target));
            }
            return;
        }
        let from = self.node(from, place.clone());
        let to = if to == "[*]" { self.end(scope, place.clone()) } else { self.node(to, place.clone()) };
        let label_at = place.start + line.len() - label.trim_start().len();
        self.labels.push((unescaped(label), label_at));
        let (trigger, stays) = (Trigger::Unsaid, false);
        self.chart.arrows.push(Arrow { from, to, trigger, when: None, otherwise: false, stays, place });
    }

    /// `[*]` at the point of an arrow.
    fn end(&mut self, scope: usize, place: Range<usize>) -> usize {
        let key = format!("{scope} [*]");
        if let Some(&known) = self.known.get(&key) {
            return known;
        }
        let name = self
            .chart
            .nodes
            .get(scope)
            .filter(|n| !n.id.is_empty())
            .map_or("final".to_owned(), |n| format!("{}_final", n.id));
        let node = self.chart.add(&name, Kind::Final, scope, place);
        self.known.insert(key, node);
        node
    }

    /// What follows the word `state`.
    fn state(&mut self, rest: &str, place: Range<usize>) {
        let (rest, opens) = match rest.strip_suffix('{') {
            Some(rest) => (rest.trim(), true),
            None => (rest, false),
        };
        let quoted = rest.strip_prefix('"').and_then(|r| r.split_once('"'));
        let (id, description) = match (quoted, rest.split_once(" as "), rest.split_once(':')) {
            (Some((description, as_id)), _, _) => {
                let id = as_id.trim().strip_prefix("as ").unwrap_or("").trim();
                (if id.is_empty() { description } else { id }, Some(description))
            }
            (None, Some((id, description)), _) => (id.trim(), Some(description.trim().trim_matches('"'))),
            (None, None, Some((id, description))) if !description.starts_with("::") => {
                (id.trim(), Some(description.trim()))
            }
            _ => (plain(rest), None),
        };
        let (id, stereotype) = match id.find("<<").or_else(|| id.find("[[")) {
            Some(at) => {
                (id.get(..at).unwrap_or("").trim(), id.get(at + 2..).unwrap_or("").trim_end_matches(['>', ']']))
            }
            None => (id, ""),
        };
        if id.is_empty() || (quoted.is_none() && !self.is_id(id, &place)) {
            self.failed = true;
            return;
        }
        let node = self.node(id, place.clone());
        match stereotype.trim() {
            "" => {}
            "choice" => self.chart.nodes[node].kind = Kind::Choice,
            "fork" | "join" => self.chart.nodes[node].kind = Kind::Fork,
            "history" | "H" | "H*" => self.chart.nodes[node].kind = Kind::History,
            other => self.wrong(place.clone(), Code::ImportSyntax, format!("`<<{other}>>` is not known")),
        }
        if let Some(description) = description {
            self.described(id, description, place.clone());
        }
        if opens {
            self.open(node, place);
        }
    }

    fn open(&mut self, node: usize, place: Range<usize>) {
        let around = self.inner();
        if self.scopes.len() > MOST_DEPTH || self.chart.is_in(around, node) && node != 0 {
            return self.wrong(place, Code::ImportRefused, "states are nested too deeply, or in themselves");
        }
        // A state that was named outside belongs where it is opened.
        let parent = self.chart.nodes[node].parent;
        if parent != around && node != 0 {
            self.chart.nodes[parent].children.retain(|c| *c != node);
            self.chart.nodes[node].parent = around;
            self.chart.nodes[around].children.push(node);
        }
        self.scopes.push(Scope { node, region: None });
    }

    fn close_one(&mut self, place: Range<usize>) {
        if self.scopes.len() < 2 {
            return self.wrong(place, Code::ImportSyntax, "`}` closes nothing");
        }
        self.scopes.pop();
    }

    fn close(&mut self, end: usize) {
        if self.scopes.len() > 1 {
            let end = self.base + end;
            self.wrong(end..end, Code::ImportSyntax, "a `{` is not closed");
        }
    }

    /// `--` parts regions.
    fn next_region(&mut self, place: Range<usize>) {
        let Some(scope) = self.scopes.last() else { return };
        let (node, first) = (scope.node, scope.region.is_none());
        if first {
            let children = std::mem::take(&mut self.chart.nodes[node].children);
            let initial = self.chart.nodes[node].initial.take();
            self.chart.nodes[node].kind = Kind::Parallel;
            let region = self.chart.add("", Kind::Region, node, place.clone());
            for child in &children {
                self.chart.nodes[*child].parent = region;
            }
            self.chart.nodes[region].children = children;
            self.chart.nodes[region].initial = initial;
        }
        let region = self.chart.add("", Kind::Region, node, place);
        if let Some(scope) = self.scopes.last_mut() {
            scope.region = Some(region);
        }
    }

    /// `id : description`. The description of a drawing of ours has the name of the state first and then its bounds.
    fn described(&mut self, id: &str, description: &str, place: Range<usize>) {
        let node = self.node(id, place);
        let text = unescaped(description);
        let mut lines = text.lines().map(str::trim);
        let shown = lines.next().unwrap_or("");
        let bounds: Vec<&str> = lines.collect();
        if !bounds.is_empty()
            && let Some((Some((_, clauses)), None, false)) = annotation(&format!("state a {}", bounds.join(" ")))
            && clauses.on.is_none()
            && clauses.when.is_none()
        {
            self.chart.nodes[node].own.bounds = clauses.bounds;
        }
        let frame = self.chart.nodes.get(self.inner()).map_or("", |n| n.id.as_str());
        if id == format!("{frame}_{shown}") && !shown.is_empty() {
            self.chart.nodes[node].id = shown.to_owned();
        }
    }

    /// States whose names are prose keep what can be a name of it.
    fn name_states(&mut self) {
        for node in self.chart.nodes.iter_mut().skip(1).filter(|n| !n.id.is_empty()) {
            let name = slug(&node.id);
            if name != node.id && node.children.is_empty() && node.kind == Kind::State {
                let span = self.report.span(node.place.start, node.place.end);
                self.report.push(renamed("state", &node.id, &name, span));
            }
        }
    }

    fn read_labels(&mut self) {
        for number in 0..self.chart.arrows.len() {
            let Some((text, at)) = self.labels.get(number).cloned() else { continue };
            let from = self.chart.arrows[number].from;
            let annotated = self.chart.around(from).any(|n| self.chart.nodes[n].annotation.is_some());
            let place = match (annotated, self.chart.nodes[from].kind) {
                (_, Kind::Choice) => Place::Choice,
                (true, _) => Place::Machine,
                (false, _) => Place::Drawn,
            };
            let label = chart::label(&text, place);
            let said = |range: &Option<Range<usize>>| range.clone().map(|r| at + r.start..at + r.end);
            if let (Some((written, range)), Some(on)) = (&label.renamed, &label.on) {
                let place = at + range.start..at + range.end;
                self.report.push(renamed("event", written, on, self.report.span(place.start, place.end)));
            }
            if let Some(place) = said(&label.prose) {
                let what = label.when.as_ref().map(lapwing_syntax::print_expr).unwrap_or_default();
                let message = format!("the guard is a text: it has become the signal `{what}`");
                let span = self.report.span(place.start, place.end);
                let help = "write a condition in its place, or declare what it stands for";
                self.report.push(Diagnostic::new(Code::ImportTrigger, span, message).help(help));
            }
            if let Some(place) = said(&label.given) {
                let message = "what stands in brackets behind an event does not come along";
                let span = self.report.span(place.start, place.end);
                let help = "a time is a bound on staying, `state NAME at most 2 s`; what an event carries are its fields, in a guard";
                self.report.push(Diagnostic::new(Code::ImportTrigger, span, message).help(help));
            }
            if let Some(place) = said(&label.action) {
                let message = "what is done on the way does not come along";
                let span = self.report.span(place.start, place.end);
                self.report.push(Diagnostic::new(Code::ImportCode, span, message));
            }
            let has_final = self.chart.nodes[from].children.iter().any(|c| self.chart.nodes[*c].kind == Kind::Final);
            let arrow = &mut self.chart.arrows[number];
            arrow.trigger = match (label.on, &label.when) {
                (Some(event), _) => Trigger::Event(event),
                (None, Some(_)) => Trigger::Eventless,
                // Out of a state that can be done it leads on when that is.
                (None, None) if has_final => Trigger::Done,
                (None, None) => Trigger::Unsaid,
            };
            (arrow.when, arrow.otherwise) = (label.when, label.otherwise);
        }
    }
}

/// A name without what says how it looks.
fn plain(id: &str) -> &str {
    id.split(":::").next().unwrap_or(id).trim()
}

/// A text without Mermaid's escapes: `#59;` and `<br>`.
fn unescaped(text: &str) -> String {
    let mut out = String::new();
    let mut rest = text.trim();
    while let Some(c) = rest.chars().next() {
        let code = rest.strip_prefix('#').and_then(|r| r.split_once(';'));
        let escaped = code.and_then(|(code, behind)| Some((char::from_u32(code.parse().ok()?)?, behind)));
        let line = ["<br>", "<br/>", "<br />", "\\n"].iter().find_map(|b| rest.strip_prefix(b));
        match (escaped, line) {
            (Some((c, behind)), _) => {
                out.push(c);
                rest = behind;
            }
            (None, Some(behind)) => {
                out.push('\n');
                rest = behind;
            }
            _ => {
                out.push(c);
                rest = rest.get(c.len_utf8()..).unwrap_or("");
            }
        }
    }
    out
}
