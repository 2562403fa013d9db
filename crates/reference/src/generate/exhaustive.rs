//! Every temporal operator with every small bound, on every short trace of two booleans.

use super::samples::Raw;
use lapwing_stream::{Time, Value};

/// A row per second; `[p, q]`.
pub type Rows = Vec<[bool; 2]>;

/// All traces of up to so many rows, the shortest first; none is empty.
pub fn traces(longest: usize) -> Vec<Rows> {
    let mut all = Vec::new();
    let mut longer: Vec<Rows> = vec![Vec::new()];
    for _ in 0..longest {
        let extended = |rows: &Rows| -> Vec<Rows> {
            let with = |row: [bool; 2]| rows.iter().copied().chain([row]).collect();
            [[false, false], [false, true], [true, false], [true, true]].map(with).to_vec()
        };
        longer = longer.iter().flat_map(extended).collect();
        all.extend(longer.iter().cloned());
    }
    all
}

/// The samples of a trace: columns `p` and `q`, a second apart, from 0 s on.
pub fn samples(rows: &Rows) -> Vec<(Time, Raw)> {
    let cells = |[p, q]: &[bool; 2]| vec![("p".to_string(), Value::Bool(*p)), ("q".to_string(), Value::Bool(*q))];
    rows.iter().enumerate().map(|(n, row)| (Time(n as i64 * 1_000_000_000), Raw::Row(cells(row)))).collect()
}

/// A specification with a property for each formula, `f0`, `f1`, ….
pub fn text(longest_bound: usize) -> String {
    let all = formulas(longest_bound);
    all.iter().enumerate().map(|(n, formula)| format!("property f{n}: {formula}\n")).collect()
}

/// All formulas of one or two temporal operators over `p` and `q`, with bounds up to so many seconds.
pub fn formulas(longest_bound: usize) -> Vec<String> {
    let bounds = bounds(longest_bound);
    let mut all = Vec::new();
    for bound in &bounds {
        for operator in ["always", "eventually", "once", "historically"] {
            all.push(format!("{operator}{bound} p"));
        }
        all.push(format!("p until{bound} q"));
        all.push(format!("p since{bound} q"));
        all.push(format!("whenever p, eventually{bound} q"));
        all.push(format!("whenever p, always{bound} q"));
        all.push(format!("always (p until{bound} q)"));
    }
    for operator in ["never", "next", "previously", "becomes"] {
        all.push(format!("{operator} p"));
        all.push(format!("{operator} {operator} p").replace("previously previously p", "previously (previously p)"));
    }
    all.extend((0..=longest_bound).map(|d| format!("held for {d} s p")));
    for body in ["q", "eventually q", "next q", "always next q", "eventually within 1 s q", "previously q"] {
        for scope in ["after", "until", "before", "while", "whenever"] {
            all.push(format!("{scope} p, {body}"));
            all.push(format!("always ({scope} p, {body})"));
            all.push(format!("eventually ({scope} p, {body})"));
        }
        all.push(format!("after_until p, q, {body}"));
        all.push(format!("after_until q, (p and not q), {body}"));
    }
    for outer in ["after", "until", "before", "while"] {
        for inner in ["after", "until", "before", "while", "whenever"] {
            all.push(format!("{outer} p, ({inner} q, eventually p)"));
            all.push(format!("{outer} next p, ({inner} q, p)"));
            all.push(format!("{outer} p, ({inner} next q, p)"));
        }
    }
    all
}

/// No bound, and every interval with its ends in and out.
fn bounds(longest: usize) -> Vec<String> {
    let mut all = vec![String::new()];
    for hi in 0..=longest {
        all.push(format!(" within {hi} s"));
        for lo in 0..=hi {
            for (left, right) in [("[", "]"), ("[", ")"), ("(", "]"), ("(", ")")] {
                all.push(format!(" within {left}{lo} s, {hi} s{right}"));
            }
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_are_as_many_as_there_should_be() {
        assert_eq!(traces(3).len(), 4 + 16 + 64);
        // One without, one `within d` for each end, four for each of the ten pairs.
        assert_eq!(bounds(3).len(), 1 + 4 + 40);
    }
}
