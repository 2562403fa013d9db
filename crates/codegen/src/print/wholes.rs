//! Functions that take an array or a text and work out what is asked of it.

use crate::Interface;
use crate::code::{Expr, Unit};
use crate::elements::Column;
use crate::interface::{Kind, Member};
use crate::prune::below;
use crate::texts::{Codes, FNV};
use crate::wholes::{Shape, What, Whole};

use super::c::C;
use super::rust::Rust;
use super::{Syntax, Writer};

impl Interface {
    /// What stands for a text that is not written down, for the reader of the file.
    pub(crate) fn other_texts(&self) -> &'static str {
        match self.codes {
            Codes::Listed => "is 0",
            Codes::Hashed => "has a number that functions that take texts work out",
        }
    }

    /// The arrays and texts that something is asked of, each with its parts and the members that these become.
    pub(crate) fn asked(&self) -> impl Iterator<Item = (&Whole, Vec<(&Member, &What)>)> {
        self.wholes.iter().filter_map(move |whole| {
            let member = |part: &'_ crate::wholes::Part| self.members.iter().find(|m| m.from == part.from);
            let parts: Vec<_> = whole.parts.iter().filter_map(|p| Some((member(p)?, &p.what))).collect();
            (!parts.is_empty()).then_some((whole, parts))
        })
    }

    /// What is said of elements of arrays.
    pub(crate) fn bodies(&self) -> impl Iterator<Item = &Expr> {
        self.wholes.iter().flat_map(|whole| &whole.parts).filter_map(|part| part.what.body())
    }

    /// Whether a function asks that of what it takes.
    fn asks(&self, is: impl Fn(&What) -> bool) -> bool {
        self.asked().any(|(_, parts)| parts.iter().any(|(_, what)| is(what)))
    }
}

fn doc(whole: &Whole) -> String {
    let label = &whole.label;
    match whole.shape {
        Shape::Numbers => {
            format!("The array `{label}` came: works out what is asked of it, and keeps no more of it than that.")
        }
        Shape::Columns => format!(
            "The array `{label}` came: works out what is asked of it. For each part of its elements that is read it wants an array of `count`."
        ),
        Shape::Text => format!("The text `{label}` came: works out what is asked of it, and does not keep it."),
        Shape::Table(_) => {
            format!(
                "The array `{label}` came, or the names of its elements: finds those that are asked for by name. Wants the latest of both."
            )
        }
    }
}

/// As methods of what comes with a step.
pub(super) fn rust(w: &mut Writer<'_, Rust>, interface: &Interface) {
    for (number, (whole, parts)) in interface.asked().enumerate() {
        if number > 0 {
            w.line("");
        }
        w.comment("///", &doc(whole));
        let params = match whole.shape {
            Shape::Numbers => "of: &[f64]".to_owned(),
            Shape::Text => "text: &str".to_owned(),
            Shape::Table(_) => "names: &[&str], of: &[f64]".to_owned(),
            Shape::Columns => {
                let of = |c: &Column| {
                    format!(
                        ", {}: &[{}]",
                        c.name(),
                        if c.kind == Kind::Text { "&str" } else { Rust.ty(c.kind.ty(interface.codes)) }
                    )
                };
                format!("count: usize{}", whole.columns.iter().map(of).collect::<String>())
            }
        };
        w.line(&format!("pub fn {}(&mut self, {params}) {{", whole.setter));
        w.inside(|w| {
            if whole.shape == Shape::Columns && parts.iter().all(|(_, what)| matches!(what, What::At(..))) {
                w.line("let _ = count;");
            }
            parts.iter().for_each(|(member, what)| rust_part(w, whole, member, what));
        });
        w.line("}");
    }
}

fn rust_part(w: &mut Writer<'_, Rust>, whole: &Whole, member: &Member, what: &What) {
    let name = &member.name;
    let of_all = |sign: &str| {
        format!("of.iter().fold(f64::NAN, |best, &x| if x.is_nan() || x {sign} best {{ best }} else {{ x }})")
    };
    let value = match what {
        What::Length if whole.shape == Shape::Columns => "count as f64".to_owned(),
        What::Length => "of.len() as f64".to_owned(),
        What::Least => of_all(">="),
        What::Greatest => of_all("<="),
        What::Element(n) => format!("of.get({n}).copied().unwrap_or(f64::NAN)"),
        What::At(n, column) => format!("{}.get({n}).copied().unwrap_or(f64::NAN)", column.name()),
        What::Any(body) if whole.shape == Shape::Columns => rust_any(w, whole, body),
        What::Any(body) => format!("of.iter().any(|&x| !x.is_nan() && {})", w.operand(body, None)),
        What::Beside(name) => {
            format!(
                "names.iter().position(|&name| name == {name:?}).and_then(|i| of.get(i)).copied().unwrap_or(f64::NAN)"
            )
        }
        What::Code => "code(text)".to_owned(),
        What::StartsWith(other) => format!("text.starts_with({other:?})"),
        What::EndsWith(other) => format!("text.ends_with({other:?})"),
        What::Contains(other) => format!("text.contains({other:?})"),
    };
    w.line(&format!("self.{name} = {value};"));
    if let Some(has) = &member.has {
        w.line(&format!("self.{has} = true;"));
    }
}

/// Whether something is true of any element of which there are parts: a part that is missing ends the array.
fn rust_any(w: &Writer<'_, Rust>, whole: &Whole, body: &Expr) -> String {
    let read = whole.columns.iter().filter(|column| reads(body, column));
    let mut parts = "0..count".to_owned();
    let mut names = "_".to_owned();
    for column in read {
        parts = format!("({parts}).zip({})", column.name());
        names = format!("({names}, &{})", column.element());
    }
    let parts = if parts == "0..count" { "(0..count)".to_owned() } else { parts };
    format!("{parts}.any(|{names}| {})", w.expr(body))
}

/// Whether what is said of an element reads that part of it.
fn reads(body: &Expr, column: &Column) -> bool {
    let mut found = false;
    below(body, &mut |e| found |= matches!(e, Expr::Local(name) if *name == column.element()));
    found
}

/// The function that gives the code of a text, where one is called.
pub(super) fn rust_code(w: &mut Writer<'_, Rust>, interface: &Interface) {
    if !interface.asks(|what| *what == What::Code) {
        return;
    }
    if interface.codes == Codes::Hashed {
        w.lines(&with_fnv(RUST_HASH));
        return;
    }
    w.line("");
    w.line("/// The code of a text.");
    w.line("fn code(text: &str) -> u32 {");
    w.inside(|w| {
        w.line("match text {");
        w.inside(|w| {
            interface.texts.iter().for_each(|text| w.line(&format!("{:?} => {},", text.text, text.name)));
            w.line("_ => 0,");
        });
        w.line("}");
    });
    w.line("}");
}

fn with_fnv(text: &str) -> String {
    text.replace("BASIS", &format!("{:#018x}", FNV.0)).replace("PRIME", &format!("{:#x}", FNV.1))
}

const RUST_HASH: &str = "
/// The number of a text, which follows from its bytes: FNV-1a (Fowler, Noll, Vo) without its last bit.
fn code(text: &str) -> u64 {
    text.bytes().fold(BASIS, |hash: u64, byte| (hash ^ u64::from(byte)).wrapping_mul(PRIME)) >> 1
}
";

/// As functions on what comes with a step: their declarations for the header.
pub(super) fn c_header(w: &mut Writer<'_, C>, interface: &Interface) {
    for (whole, _) in interface.asked() {
        w.line("");
        w.comment("//", &doc(whole));
        let line = format!("{};", c_signature(w, whole));
        w.line(&line);
    }
}

/// See [`c_header`]: the functions.
pub(super) fn c_source(w: &mut Writer<'_, C>, interface: &Interface) {
    c_helpers(w, interface);
    for (whole, parts) in interface.asked() {
        w.line("");
        let line = format!("{} {{", c_signature(w, whole));
        w.line(&line);
        w.inside(|w| {
            let all = |is: fn(&What) -> bool| parts.iter().all(|(_, what)| is(what));
            if whole.shape == Shape::Numbers && all(|what| *what == What::Length) {
                w.line("(void)of;");
            }
            if all(|what| looked_for(what).is_some_and(str::is_empty)) {
                w.line("(void)text;");
                w.line("(void)length;");
            }
            parts.iter().for_each(|(member, what)| c_part(w, whole, member, what));
        });
        w.line("}");
    }
}

/// The text that another is looked through for.
fn looked_for(what: &What) -> Option<&str> {
    match what {
        What::StartsWith(other) | What::EndsWith(other) | What::Contains(other) => Some(other),
        _ => None,
    }
}

fn c_signature(w: &Writer<'_, C>, whole: &Whole) -> String {
    let prefix = &w.syntax.prefix;
    let params = match whole.shape {
        Shape::Numbers => "const double *of, uint32_t count".to_owned(),
        Shape::Text => "const char *text, uint32_t length".to_owned(),
        Shape::Table(_) => "const char *const *names, uint32_t name_count, const double *of, uint32_t count".to_owned(),
        Shape::Columns => {
            let of = |c: &Column| format!("const {} *{}, ", c_element(c), c.name());
            format!("{}uint32_t count", whole.columns.iter().map(of).collect::<String>())
        }
    };
    format!("void {prefix}_{}({prefix}_inputs *in, {params})", whole.setter)
}

/// The type of the elements of an array of parts.
fn c_element(column: &Column) -> &'static str {
    match column.kind {
        Kind::Truth => "bool",
        Kind::Number => "double",
        Kind::Text => "char *const",
    }
}

fn c_part(w: &mut Writer<'_, C>, whole: &Whole, member: &Member, what: &What) {
    let (to, nan, prefix) = (format!("in->{}", member.name), w.syntax.float(f64::NAN), w.syntax.prefix.clone());
    let first = match what {
        What::Length => "(double)count".to_owned(),
        What::Element(n) => format!("count > {n} ? of[{n}] : {nan}"),
        What::At(n, column) => format!("count > {n} ? {}[{n}] : {nan}", column.name()),
        What::Least | What::Greatest | What::Beside(_) => nan,
        What::Any(_) => "false".to_owned(),
        What::Code => format!("{prefix}_code_of(text, length)"),
        What::StartsWith(other) => found(&prefix, other, "text", ">="),
        What::EndsWith(other) => found(&prefix, other, &format!("text + (length - {})", other.len()), ">="),
        What::Contains(other) if other.is_empty() => "true".to_owned(),
        What::Contains(other) => format!("{prefix}_contains(text, length, {}, {})", c_text(other), other.len()),
    };
    w.line(&format!("{to} = {first};"));
    match what {
        What::Least => each(w, OF, &format!("x == x && !(x >= {to})"), &format!("{to} = x;")),
        What::Greatest => each(w, OF, &format!("x == x && !(x <= {to})"), &format!("{to} = x;")),
        What::Any(body) if whole.shape == Shape::Columns => {
            let read = whole.columns.iter().filter(|column| reads(body, column));
            let parts = read.map(|c| format!("const {} {} = {}[i];", c_element(c), c.element(), c.name()));
            let parts: Vec<String> = parts.collect();
            each(w, &parts, &w.expr(body), &format!("{to} = true;"));
        }
        What::Any(body) => each(w, OF, &format!("x == x && {}", w.operand(body, None)), &format!("{to} = true;")),
        What::Beside(name) => beside(w, &to, name),
        _ => {}
    }
    if let Some(has) = &member.has {
        w.line(&format!("in->{has} = true;"));
    }
}

/// Whether a text is found at a place of another, if that is long enough.
fn found(prefix: &str, text: &str, at: &str, long_enough: &str) -> String {
    match text.len() {
        0 if long_enough == ">=" => "true".to_owned(),
        0 => "length == 0".to_owned(),
        len => format!("length {long_enough} {len} && {prefix}_same({at}, {}, {len})", c_text(text)),
    }
}

/// An element of an array of numbers.
const OF: &[&str] = &["const double x = of[i];"];

/// What is done for the elements of which something is true; first its parts are named.
fn each(w: &mut Writer<'_, C>, parts: &[impl AsRef<str>], condition: &str, then: &str) {
    w.line("for (uint32_t i = 0; i < count; i++) {");
    w.inside(|w| {
        parts.iter().for_each(|part| w.line(part.as_ref()));
        w.line(&format!("if ({condition}) {{"));
        w.inside(|w| w.line(then));
        w.line("}");
    });
    w.line("}");
}

/// The element beside the first name that is this.
fn beside(w: &mut Writer<'_, C>, to: &str, name: &str) {
    let (prefix, len) = (w.syntax.prefix.clone(), name.len());
    w.line("for (uint32_t i = 0; i < name_count; i++) {");
    w.inside(|w| {
        w.line(&format!("if ({prefix}_names(names[i], {}, {len})) {{", c_text(name)));
        w.inside(|w| {
            w.line("if (i < count) {");
            w.inside(|w| w.line(&format!("{to} = of[i];")));
            w.line("}");
            w.line("break;");
        });
        w.line("}");
    });
    w.line("}");
}

fn c_helpers(w: &mut Writer<'_, C>, interface: &Interface) {
    let (asks_code, contains) = (interface.asks(|w| *w == What::Code), |what: &What| matches!(what, What::Contains(_)));
    let is_found = |what: &What| looked_for(what).is_some_and(|other| !other.is_empty());
    let prefix = w.syntax.prefix.clone();
    let has_texts = interface.texts.iter().any(|text| !text.text.is_empty());
    let is_listed = asks_code && interface.codes == Codes::Listed;
    if interface.asks(is_found) || (is_listed && has_texts) {
        w.lines(&C_SAME.replace("NAME", &prefix));
    }
    if interface.asks(|what| contains(what) && is_found(what)) {
        w.lines(&C_CONTAINS.replace("NAME", &prefix));
    }
    let is_same = |body: &Expr| {
        let mut found = false;
        below(body, &mut |e| found |= matches!(e, Expr::Same(..)));
        found
    };
    if interface.asks(|what| matches!(what, What::Beside(_)) || what.body().is_some_and(is_same)) {
        w.lines(&C_NAMES.replace("NAME", &prefix));
    }
    if asks_code && !is_listed {
        w.lines(&with_fnv(C_HASH).replace("NAME", &prefix));
    }
    if is_listed {
        c_codes(w, interface, has_texts);
    }
}

/// The function that finds a text among those that are written down.
fn c_codes(w: &mut Writer<'_, C>, interface: &Interface, has_texts: bool) {
    let prefix = w.syntax.prefix.clone();
    w.line("");
    w.line("/* The code of a text. */");
    w.line(&format!("static uint32_t {prefix}_code_of(const char *text, uint32_t length) {{"));
    w.inside(|w| {
        if !has_texts {
            w.line("(void)text;");
        }
        if interface.texts.is_empty() {
            w.line("(void)length;");
        }
        for text in &interface.texts {
            w.line(&format!("if ({}) {{", found(&prefix, &text.text, "text", "==")));
            w.inside(|w| w.line(&format!("return {}_{};", prefix.to_uppercase(), text.name)));
            w.line("}");
        }
        w.line("return 0;");
    });
    w.line("}");
}

/// A text between quotes; what is not plain in its bytes.
pub(super) fn c_text(text: &str) -> String {
    let escaped = text.bytes().map(|byte| match byte {
        b'"' | b'\\' | b'?' => format!("\\{}", char::from(byte)),
        b' '..=b'~' => char::from(byte).to_string(),
        byte => format!("\\{byte:03o}"),
    });
    format!("\"{}\"", escaped.collect::<String>())
}

const C_HASH: &str = "
/* The number of a text, which follows from its bytes: FNV-1a (Fowler, Noll, Vo) without its last bit. */
static uint64_t NAME_code_of(const char *text, uint32_t length) {
    uint64_t hash = UINT64_C(BASIS);
    for (uint32_t i = 0; i < length; i++) {
        hash = (hash ^ (unsigned char)text[i]) * UINT64_C(PRIME);
    }
    return hash >> 1;
}
";

const C_SAME: &str = "
/* Whether two texts begin with the same bytes. */
static bool NAME_same(const char *a, const char *b, uint32_t length) {
    for (uint32_t i = 0; i < length; i++) {
        if (a[i] != b[i]) {
            return false;
        }
    }
    return true;
}
";

const C_CONTAINS: &str = "
/* Whether a text stands somewhere in another. */
static bool NAME_contains(const char *text, uint32_t length, const char *part, uint32_t part_length) {
    for (uint32_t i = 0; i + part_length <= length; i++) {
        if (NAME_same(text + i, part, part_length)) {
            return true;
        }
    }
    return false;
}
";

const C_NAMES: &str = "
/* Whether a text that ends with a zero is another. */
static bool NAME_names(const char *text, const char *other, uint32_t length) {
    for (uint32_t i = 0; i < length; i++) {
        if (text[i] != other[i] || text[i] == 0) {
            return false;
        }
    }
    return text[length] == 0;
}
";

/// Shows what functions that take arrays compute, so that they get what they call.
pub(super) fn expressions<'e>(unit: &'e Unit, interface: &'e Interface, see: &mut impl FnMut(&Expr)) {
    unit.functions.iter().for_each(|f| crate::prune::reads(&f.body, &mut *see));
    interface.bodies().for_each(see);
}
