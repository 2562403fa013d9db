//! Programs that drive generated monitors by the words of `steps`.

use lapwing_codegen::{Generated, Kind};

use super::members;

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
                Kind::Text => "value as u32",
            };
            let has = member.has.as_ref().map(|has| format!(" inputs.{has} = true;")).unwrap_or_default();
            format!("            {i} => {{ inputs.{} = {value};{has} }}\n", member.name)
        })
        .collect();
    let arrays = monitor.interface.arrays.iter().enumerate();
    let arrays: String =
        arrays.map(|(i, array)| format!("                    \"{i}\" => inputs.{}(&of),\n", array.setter)).collect();
    RUST_RUNNER.replace("NUMBER", &number.to_string()).replace("SETS", &sets).replace("ARRAYS", &arrays)
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
            if let Some(array) = member.strip_prefix('a') {
                let of = value.split(';').filter(|x| !x.is_empty());
                let of: Vec<f64> = of.map(|x| x.parse().expect("an element")).collect();
                match array {
ARRAYS                    _ => panic!("no such array"),
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

/// C: all monitors in one unit.
pub fn c(monitors: &[&Generated]) -> String {
    let mut text = "#include <stdio.h>\n#include <stdlib.h>\n#include <string.h>\n#include <inttypes.h>\n".to_owned();
    let mut choices = String::new();
    for monitor in monitors {
        text += &format!("#include \"{}.c\"\n", monitor.interface.prefix);
    }
    text += "static char line[65536];\nstatic double elements[1024];\n";
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
                Kind::Text => "(uint32_t)value",
            };
            let has = member.has.as_ref().map(|has| format!(" in.{has} = true;")).unwrap_or_default();
            format!("            case {i}: in.{} = {value};{has} break;\n", member.name)
        })
        .collect();
    let prefix = &monitor.interface.prefix;
    let arrays = monitor.interface.arrays.iter().enumerate();
    let arrays: String = arrays
        .map(|(i, array)| {
            format!("                case {i}: {prefix}_{}(&in, elements, count); break;\n", array.setter)
        })
        .collect();
    C_RUNNER
        .replace("NUMBER", &number.to_string())
        .replace("SETS", &sets)
        .replace("ARRAYS", &arrays)
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
            if (at[1] == 'a') {
                uint32_t count = 0;
                long array = strtol(at + 2, &at, 10);
                for (at++; *at != ' ' && *at != '\n'; at += *at == ';') {
                    elements[count++] = strtod(at, &at);
                }
                switch (array) {
ARRAYS                default: exit(5);
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
