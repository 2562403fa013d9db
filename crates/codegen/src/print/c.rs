//! C99: a header and a source file, on freestanding headers alone, and `math.h` where a formula has roots or trigonometry.

use super::prelude::{Spelling, spelling};
use super::{Syntax, Writer, helpers, objects, wholes, without_trigraphs};
use crate::Interface;
use crate::code::{Expr, Function, Helper, Ty, Unit};
use crate::interface::{CAUSES, VERDICTS};
use crate::prune::PUBLIC;

pub(super) struct C {
    /// What every name begins with.
    pub prefix: String,
}

impl Syntax for C {
    fn ty(&self, ty: Ty) -> &'static str {
        match ty {
            Ty::Bool => "bool",
            Ty::U8 => "uint8_t",
            Ty::U32 => "uint32_t",
            Ty::U64 => "uint64_t",
            Ty::I64 => "int64_t",
            Ty::F64 => "double",
        }
    }

    fn float(&self, x: f64) -> String {
        match x {
            _ if x.is_nan() => "(0.0 / 0.0)".to_owned(),
            f64::INFINITY => "(1.0 / 0.0)".to_owned(),
            f64::NEG_INFINITY => "(-1.0 / 0.0)".to_owned(),
            _ => format!("{x:?}"),
        }
    }

    fn field(&self, name: &str) -> String {
        format!("m->{name}")
    }

    fn element(&self, name: &str, at: &str) -> String {
        format!("m->{name}[{at}]")
    }

    fn input(&self, name: &str) -> String {
        format!("in->{name}")
    }

    fn inputs(&self) -> &'static str {
        "in"
    }

    fn choose(&self, condition: &str, then: &str, other: &str) -> String {
        format!("{condition} ? {then} : {other}")
    }

    fn brackets_choices(&self) -> bool {
        true
    }

    fn cast(&self, ty: Ty, of: &str) -> String {
        format!("({}){of}", self.ty(ty))
    }

    fn call(&self, helper: Helper, args: &str) -> String {
        match spelling(helper) {
            Spelling { c, c_text: "", .. } => format!("{c}({args})"),
            Spelling { c, .. } => format!("{}_{c}({args})", self.prefix),
        }
    }

    fn same(&self, of: &str, text: &str) -> String {
        format!("{}_names({of}, {}, {})", self.prefix, wholes::c_text(text), text.len())
    }

    fn variable(&self, name: &str, ty: Ty, value: &str, is_set: bool) -> String {
        let word = if is_set { "" } else { "const " };
        format!("{word}{} {name} = {value};", self.ty(ty))
    }

    fn head(&self, keyword: &str, of: &str) -> String {
        format!("{keyword} ({of})")
    }

    fn count_up(&self, name: &str, below: &str) -> String {
        format!("for (uint32_t {name} = 0; {name} < {below}; {name}++)")
    }

    fn arm(&self, number: u8) -> String {
        format!("case {number}: {{")
    }

    fn arm_end(&self) -> &'static [&'static str] {
        &["    break;", "}"]
    }

    fn otherwise(&self) -> &'static str {
        "default: break;"
    }

    fn choice(&self, of: &str) -> String {
        format!("switch ({of})")
    }

    fn fill(&self, name: &str, value: &str, len: usize) -> Vec<String> {
        let head = format!("for (uint32_t k = 0; k < {len}; k++) {{");
        vec![head, format!("    m->{name}[k] = {value};"), "}".to_owned()]
    }

    fn call_own(&self, function: &Function, args: &[String]) -> String {
        let mut all = vec!["m".to_owned()];
        all.extend(args.iter().cloned());
        if function.takes_inputs {
            all.push("in".to_owned());
        }
        format!("{}({});", self.name(function), all.join(", "))
    }

    fn unread(&self, name: &str) -> String {
        format!("(void){name};")
    }
}

impl C {
    fn name(&self, function: &Function) -> String {
        format!("{}_{}", self.prefix, function.name)
    }

    fn signature(&self, function: &Function) -> String {
        let mut params = vec![format!("{}_monitor *m", self.prefix)];
        params.extend(function.params.iter().map(|(name, ty)| format!("{} {name}", self.ty(*ty))));
        if function.takes_inputs {
            params.push(format!("const {}_inputs *in", self.prefix));
        }
        format!("void {}({})", self.name(function), params.join(", "))
    }
}

/// The texts of the header and of the source file.
pub(crate) fn c(unit: &Unit, interface: &Interface) -> (String, String) {
    (header(unit, interface), source(unit, interface))
}

fn header(unit: &Unit, interface: &Interface) -> String {
    let prefix = &interface.prefix;
    let mut w = Writer::new(C { prefix: prefix.clone() }, unit);
    let upper = prefix.to_uppercase();
    w.line("/*");
    for line in interface.header("c") {
        // Neither an end of the comment nor, which compilers warn of, another beginning.
        let line = without_trigraphs(&line).replace("*/", "* /").replace("/*", "/ *");
        w.line(format!(" * {line}").trim_end());
    }
    w.line(" */");
    w.lines(&format!("#ifndef {upper}_H\n#define {upper}_H\n\n#include <stdbool.h>\n#include <stdint.h>\n"));
    w.lines("#ifdef __cplusplus\nextern \"C\" {\n#endif\n");
    w.line("/* How many properties there are, and their numbers. */");
    w.line(&format!("#define {upper}_PROPERTIES {}", interface.properties.len()));
    for (number, property) in interface.properties.iter().enumerate() {
        w.line(&format!("#define {upper}_P_{} {number}", property.macro_name));
    }
    if !interface.texts.is_empty() {
        w.lines(&format!(
            "\n/* The texts that inputs are compared with; any other text {}. */",
            interface.other_texts()
        ));
        for text in &interface.texts {
            w.line(&format!("#define {upper}_{} {}", text.name, text.code));
        }
    }
    inputs(&mut w, interface);
    words(&mut w, "What is said of a property, from the worst to the best.", "verdict", VERDICTS);
    words(&mut w, "Why a property is inconclusive.", "cause", CAUSES);
    w.lines(&OUTCOME.replace("NAME", prefix));
    monitor(&mut w);
    w.lines(&INTERFACE.replace("UPPER", &upper).replace("NAME", prefix));
    w.text
}

fn inputs(w: &mut Writer<'_, C>, interface: &Interface) {
    w.lines("\n/* What comes with a step: all zero is nothing; set what came, and that it came. */");
    w.line("typedef struct {");
    w.inside(|w| {
        for member in &interface.members {
            let ty = w.syntax.ty(member.ty);
            w.comment("//", &member.doc);
            w.line(&format!("{ty} {};", member.name));
            if let Some(has) = &member.has {
                w.line(&format!("bool {has};"));
            }
        }
        if interface.members.is_empty() {
            w.line("bool nothing;");
        }
    });
    w.line(&format!("}} {}_inputs;", interface.prefix));
    wholes::c_header(w, interface);
    objects::c_header(w, interface);
}

fn words(w: &mut Writer<'_, C>, doc: &str, name: &str, all: &[(&str, &str)]) {
    let upper = w.syntax.prefix.to_uppercase();
    w.lines(&format!("\n/* {doc} */\ntypedef enum {{"));
    w.inside(|w| {
        for (number, (word, doc)) in all.iter().enumerate() {
            let comma = if number + 1 < all.len() { "," } else { "" };
            w.comment("//", doc);
            w.line(&format!("{upper}_{} = {number}{comma}", word.to_uppercase()));
        }
    });
    let prefix = w.syntax.prefix.clone();
    w.line(&format!("}} {prefix}_{name};"));
}

/// Verdicts would be wrong without a word.
const NO_FAST_MATH: &str = "
#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error \"monitors need -fno-fast-math and -fno-finite-math-only: values that are not numbers must compare as such\"
#endif
";

const OUTCOME: &str = "
/* What became of a property. */
typedef struct {
    NAME_verdict verdict;
    NAME_cause cause;
    // Obligations met, failed and open.
    uint64_t met;
    uint64_t failed;
    uint64_t open;
    // When the obligation began that failed first, and when it failed, in nanoseconds; 0 where none failed.
    int64_t first_began;
    int64_t first_failed;
} NAME_outcome;
";

const INTERFACE: &str = "
/* Nothing has come yet. */
void NAME_init(NAME_monitor *m);
/* Something came at a time, in nanoseconds: an instant. */
void NAME_step(NAME_monitor *m, int64_t now, const NAME_inputs *in);
/* Time has come so far, and nothing came. */
void NAME_advance(NAME_monitor *m, int64_t now);
/* Works out the verdicts, as if nothing more came. */
void NAME_end(NAME_monitor *m);
/* What became of a property, from 0 to UPPER_PROPERTIES - 1, as of the last call of NAME_end. Any other number is inconclusive. */
NAME_outcome NAME_get(const NAME_monitor *m, uint32_t property);
/* How many obligations of a property have failed so far. */
uint64_t NAME_failures(const NAME_monitor *m, uint32_t property);

#ifdef __cplusplus
}
#endif

#endif
";

fn monitor(w: &mut Writer<'_, C>) {
    w.lines("\n/* The monitors: all that they remember. Its members are nobody's business. */\ntypedef struct {");
    w.inside(|w| {
        for field in &w.unit.fields {
            let ty = w.syntax.ty(field.ty);
            w.comment("//", &field.doc);
            w.line(&match field.len {
                Some(len) => format!("{ty} {}[{len}];", field.name),
                None => format!("{ty} {};", field.name),
            });
        }
    });
    let prefix = w.syntax.prefix.clone();
    w.line(&format!("}} {prefix}_monitor;"));
}

fn source(unit: &Unit, interface: &Interface) -> String {
    let prefix = &interface.prefix;
    let mut w = Writer::new(C { prefix: prefix.clone() }, unit);
    w.line(&format!("/* Generated by lapwing codegen; {prefix}.h says what it is. */"));
    w.line(&format!("#include \"{prefix}.h\""));
    w.lines(NO_FAST_MATH);
    let helpers = helpers(unit, interface);
    let from_math = |h: &Helper| spelling(*h).c_text.is_empty();
    if helpers.iter().any(from_math) {
        w.lines("\n#include <math.h>");
    }
    for helper in &helpers {
        w.lines(&spelling(*helper).c_text.replace("NAME", prefix));
    }
    wholes::c_source(&mut w, interface);
    objects::c_source(&mut w, interface);
    for function in &unit.functions {
        let public = PUBLIC.contains(&function.name.as_str());
        let signature = w.syntax.signature(function);
        w.line("");
        w.comment("//", &function.doc);
        let word = if public { "" } else { "static " };
        w.line(&format!("{word}{signature} {{"));
        w.inside(|w| w.body(function));
        w.line("}");
    }
    w.line("");
    w.line(&format!("void {prefix}_init({prefix}_monitor *m) {{"));
    w.inside(|w| {
        for field in unit.fields.iter() {
            let value = w.expr(&field.initial);
            match field.len {
                Some(len) => w.syntax.fill(&field.name, &value, len).iter().for_each(|line| w.line(line)),
                None => w.line(&format!("m->{} = {value};", field.name)),
            }
        }
    });
    w.line("}");
    w.lines(&GETTERS.replace("UPPER", &prefix.to_uppercase()).replace("NAME", prefix));
    w.text
}

const GETTERS: &str = "
NAME_outcome NAME_get(const NAME_monitor *m, uint32_t property) {
    NAME_outcome outcome = {UPPER_INCONCLUSIVE, UPPER_NO_CAUSE, 0, 0, 0, 0, 0};
    if (property < UPPER_PROPERTIES) {
        outcome.verdict = (NAME_verdict)m->verdict[property];
        outcome.cause = (NAME_cause)m->cause[property];
        outcome.met = m->met[property];
        outcome.failed = m->failed[property];
        outcome.open = m->open[property];
        outcome.first_began = m->first_began[property];
        outcome.first_failed = m->first_failed[property];
    }
    return outcome;
}

uint64_t NAME_failures(const NAME_monitor *m, uint32_t property) {
    return property < UPPER_PROPERTIES ? m->failed[property] : 0;
}
";

/// Whether an expression calls the mathematical library of C.
pub(crate) fn needs_math(e: &Expr) -> bool {
    matches!(e, Expr::Call(helper, _) if spelling(*helper).c_text.is_empty())
}
