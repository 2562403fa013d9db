//! Programs that drive generated monitors by the words of `steps`.

use std::fmt::Write;

use lapwing_codegen::{Column, Generated, Kind, Shape, Vector};

use super::objects::places;
use super::wholes::letter;
use super::{members, setters};

/// Rust: each monitor in a module of its own.
pub fn rust(monitors: &[&Generated]) -> String {
    let mut text = "#![deny(warnings)]\n#![forbid(unsafe_code)]\n".to_owned();
    let mut choices = String::new();
    for (number, monitor) in monitors.iter().enumerate() {
        let module: String = monitor.files.iter().map(|(_, text)| text.as_str()).collect();
        text += &format!("#[allow(dead_code)]\nmod m{number} {{\n{module}}}\n{}", rust_runner(number, monitor));
        choices += &format!("            \"m {number}\" => run{number}(&mut lines),\n");
    }
    text + &RUST_MAIN.replace("CHOICES", &choices)
}

fn rust_runner(number: usize, monitor: &Generated) -> String {
    let sets: String = members(&monitor.interface)
        .map(|(i, member)| {
            let value = match member.kind {
                Kind::Truth => "value != 0.0",
                Kind::Number => "value",
                // Texts are handed to functions.
                Kind::Text => return String::new(),
            };
            let has = member.has.as_ref().map(|has| format!(" inputs.{has} = true;")).unwrap_or_default();
            format!("            {i} => {{ inputs.{} = {value};{has} }}\n", member.name)
        })
        .collect();
    let wholes = monitor.interface.wholes.iter().enumerate();
    let wholes = wholes.map(|(i, whole)| {
        let args = match whole.shape {
            Shape::Numbers => "&numbers(value)".to_owned(),
            Shape::Text => "&text(value)".to_owned(),
            Shape::Columns => {
                let column = |(k, column): (usize, &Column)| match column.kind {
                    Kind::Number => format!(", &numbers(columns[{}])", k + 1),
                    Kind::Truth => {
                        format!(", &numbers(columns[{}]).iter().map(|x| *x != 0.0).collect::<Vec<_>>()", k + 1)
                    }
                    Kind::Text => {
                        format!(", &texts(columns[{}]).iter().map(String::as_str).collect::<Vec<_>>()", k + 1)
                    }
                };
                let columns: String = whole.columns.iter().enumerate().map(column).collect();
                format!("columns[0].parse().expect(\"a count\"){columns}")
            }
            Shape::Table(_) => {
                "&texts(columns[0]).iter().map(String::as_str).collect::<Vec<_>>(), &numbers(columns[1])".to_owned()
            }
        };
        format!("                    \"{}{i}\" => inputs.{}({args}),\n", letter(whole.shape), whole.setter)
    });
    let objects = setters(&monitor.interface).enumerate().map(|(i, (_, setter))| {
        let vector = |(vector, at): (Vector, usize)| {
            let elements: Vec<String> = (at..at + vector.len()).map(|k| format!("of[{k}]")).collect();
            format!("[{}]", elements.join(", "))
        };
        let vectors: Vec<String> = places(setter).map(vector).collect();
        format!("                    \"o{i}\" => inputs.{}({}),\n", setter.name, vectors.join(", "))
    });
    let taken: String = wholes.chain(objects).collect();
    RUST_RUNNER.replace("NUMBER", &number.to_string()).replace("SETS", &sets).replace("TAKEN", &taken)
}

const RUST_RUNNER: &str = r#"
#[allow(unused_mut, unused_variables, unreachable_code)]
fn runNUMBER<'a>(lines: &mut impl Iterator<Item = &'a str>) {
    let mut monitor = mNUMBER::Monitor::new();
    for line in lines {
        let mut words = line.split(' ');
        let word = words.next();
        let time = words.next().map_or(0, |w| w.parse().expect("a time"));
        let mut inputs = mNUMBER::Inputs::default();
        for (member, value) in words.filter_map(|w| w.split_once('=')) {
            if member.starts_with(|c: char| c.is_ascii_lowercase()) {
                let columns: Vec<&str> = value.split('|').collect();
                let of = if member.starts_with('o') { numbers(value) } else { Vec::new() };
                match member {
TAKEN                    _ => panic!("nothing takes that"),
                }
                continue;
            }
            let value: f64 = value.parse().expect("a value");
            match member.parse::<usize>().expect("a member") {
SETS                _ => panic!("no such member"),
            }
        }
        match word {
            Some("s") => monitor.step(time, &inputs),
            Some("a") => monitor.advance(time),
            _ => break,
        }
    }
    monitor.end();
    for p in 0..mNUMBER::PROPERTIES.len() {
        let o = monitor.outcome(p).expect("an outcome");
        println!("{} {} {} {} {} {}", o.verdict as u8, o.met, o.failed, o.open, o.first_began, o.first_failed);
        assert_eq!(o.failed, monitor.failures(p));
    }
    println!();
}
"#;

const RUST_MAIN: &str = r#"
#[allow(dead_code)]
fn numbers(value: &str) -> Vec<f64> {
    value.split(';').filter(|x| !x.is_empty()).map(|x| x.parse().expect("an element")).collect()
}

#[allow(dead_code)]
fn texts(value: &str) -> Vec<String> {
    value.split_terminator(';').map(text).collect()
}

#[allow(dead_code)]
fn text(digits: &str) -> String {
    let byte = |digits: &[u8]| u8::from_str_radix(std::str::from_utf8(digits).unwrap(), 16).expect("a byte");
    String::from_utf8(digits.as_bytes().chunks(2).map(byte).collect()).expect("a text")
}

fn main() {
    let text = std::io::read_to_string(std::io::stdin()).expect("lines");
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        match line {
CHOICES            _ => panic!("no such monitor"),
        }
    }
}
"#;

/// What a word has to hand over, read into arrays of the program's own. Gives what stands behind it.
const C_READ: &str = r#"
static char line[65536];
static double elements[1024];
static uint32_t count;
static char text[1024];
static uint32_t length;
static const char *names[64];
static uint32_t name_count;

static char *read_elements(char *at) {
    for (count = 0; *at != ' ' && *at != '\n'; at += *at == ';') {
        elements[count++] = strtod(at, &at);
    }
    return at;
}

static int digit(char c) {
    return c <= '9' ? c - '0' : c - 'a' + 10;
}

static int is_digit(char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
}

static char *read_text(char *at) {
    for (length = 0; is_digit(*at); at += 2) {
        text[length++] = (char)(digit(at[0]) * 16 + digit(at[1]));
    }
    return at;
}

static double column_numbers[4][64];
static bool column_truths[4][64];
static const char *column_texts[4][64];
static char column_bytes[4096];

/* A count, and behind it the columns of these kinds. */
char *read_columns(char *at, const char *kinds);
char *read_columns(char *at, const char *kinds) {
    uint32_t used = 0;
    count = (uint32_t)strtol(at, &at, 10);
    for (uint32_t k = 0; kinds[k]; k++) {
        at++;
        for (uint32_t i = 0; i < count; i++, at++) {
            if (kinds[k] == 't') {
                column_texts[k][i] = column_bytes + used;
                for (; is_digit(*at); at += 2) {
                    column_bytes[used++] = (char)(digit(at[0]) * 16 + digit(at[1]));
                }
                column_bytes[used++] = 0;
            } else {
                column_numbers[k][i] = strtod(at, &at);
                column_truths[k][i] = column_numbers[k][i] != 0;
            }
        }
    }
    return at;
}

static char *read_names(char *at) {
    uint32_t used = 0;
    for (name_count = 0; *at != '|'; at += *at == ';') {
        names[name_count++] = text + used;
        while (is_digit(*at)) {
            text[used++] = (char)(digit(at[0]) * 16 + digit(at[1]));
            at += 2;
        }
        text[used++] = 0;
    }
    return at;
}
"#;

/// C: all monitors in one unit.
pub fn c(monitors: &[&Generated]) -> String {
    let mut text = "#include <stdio.h>\n#include <stdlib.h>\n#include <string.h>\n#include <inttypes.h>\n".to_owned();
    let mut choices = String::new();
    for monitor in monitors {
        text += &format!("#include \"{}.c\"\n", monitor.interface.prefix);
    }
    text += C_READ;
    for (number, monitor) in monitors.iter().enumerate() {
        text += &c_runner(number, monitor);
        choices += &format!("        case {number}: run{number}(); break;\n");
    }
    text + &C_MAIN.replace("CHOICES", &choices)
}

fn c_runner(number: usize, monitor: &Generated) -> String {
    let sets: String = members(&monitor.interface)
        .map(|(i, member)| {
            let value = match member.kind {
                Kind::Truth => "value != 0.0",
                Kind::Number => "value",
                Kind::Text => return String::new(),
            };
            let has = member.has.as_ref().map(|has| format!(" in.{has} = true;")).unwrap_or_default();
            format!("            case {i}: in.{} = {value};{has} break;\n", member.name)
        })
        .collect();
    let prefix = &monitor.interface.prefix;
    let mut column_kinds = String::new();
    let wholes = monitor.interface.wholes.iter().enumerate();
    let wholes: String = wholes
        .map(|(i, whole)| {
            let args = match whole.shape {
                Shape::Numbers => "elements, count".to_owned(),
                Shape::Text => "text, length".to_owned(),
                Shape::Table(_) => "names, name_count, elements, count".to_owned(),
                Shape::Columns => {
                    let column = |(k, column): (usize, &Column)| match column.kind {
                        Kind::Number => format!("column_numbers[{k}], "),
                        Kind::Truth => format!("column_truths[{k}], "),
                        Kind::Text => format!("column_texts[{k}], "),
                    };
                    format!("{}count", whole.columns.iter().enumerate().map(column).collect::<String>())
                }
            };
            let kinds: String = whole.columns.iter().map(|c| if c.kind == Kind::Text { 't' } else { 'n' }).collect();
            if !kinds.is_empty() || whole.shape == Shape::Columns {
                let _ = writeln!(column_kinds, "                case {i}: at = read_columns(at, \"{kinds}\"); break;");
            }
            let case = format!("'{}' * 1000 + {i}", letter(whole.shape));
            format!("                case {case}: {prefix}_{}(&in, {args}); break;\n", whole.setter)
        })
        .collect();
    let objects: String = setters(&monitor.interface)
        .enumerate()
        .map(|(i, (_, setter))| {
            let vectors: String = places(setter).map(|(_, at)| format!(", elements + {at}")).collect();
            format!("                case 'o' * 1000 + {i}: {prefix}_{}(&in{vectors}); break;\n", setter.name)
        })
        .collect();
    C_RUNNER
        .replace("NUMBER", &number.to_string())
        .replace("SETS", &sets)
        .replace("COLUMNS", &column_kinds)
        .replace("TAKEN", &(wholes + &objects))
        .replace("UPPER", &prefix.to_uppercase())
        .replace("NAME", prefix)
}

const C_RUNNER: &str = r#"
static NAME_monitor monitorNUMBER;
static void runNUMBER(void) {
    NAME_init(&monitorNUMBER);
    while (fgets(line, sizeof line, stdin) && line[0] != 'e') {
        char *at = line + 1;
        int64_t time = strtoll(at, &at, 10);
        NAME_inputs in;
        memset(&in, 0, sizeof in);
        while (*at == ' ') {
            if (at[1] >= 'a' && at[1] <= 'z') {
                const char kind = at[1];
                const long number = strtol(at + 2, &at, 10);
                if (kind == 'r') {
                    at++;
                    switch (number) {
COLUMNS                    default: exit(6);
                    }
                }
                at = kind == 't' ? read_text(at + 1) : kind == 'l' ? read_names(at + 1) : at;
                at = kind == 't' || kind == 'r' ? at : read_elements(at + 1);
                switch (kind * 1000 + number) {
TAKEN                default: exit(5);
                }
                continue;
            }
            long member = strtol(at, &at, 10);
            double value = strtod(at + 1, &at);
            (void)value;
            switch (member) {
SETS            default: exit(3);
            }
        }
        if (line[0] == 's') {
            NAME_step(&monitorNUMBER, time, &in);
        } else {
            NAME_advance(&monitorNUMBER, time);
        }
    }
    NAME_end(&monitorNUMBER);
    for (uint32_t p = 0; p < UPPER_PROPERTIES; p++) {
        NAME_outcome o = NAME_get(&monitorNUMBER, p);
        printf("%d %" PRIu64 " %" PRIu64 " %" PRIu64 " %" PRId64 " %" PRId64 "\n", (int)o.verdict, o.met, o.failed, o.open, o.first_began, o.first_failed);
        if (o.failed != NAME_failures(&monitorNUMBER, p)) {
            exit(4);
        }
    }
    printf("\n");
}
"#;

const C_MAIN: &str = r#"
int main(void) {
    while (fgets(line, sizeof line, stdin)) {
        switch (atoi(line + 1)) {
CHOICES        default: return 2;
        }
    }
    return 0;
}
"#;
