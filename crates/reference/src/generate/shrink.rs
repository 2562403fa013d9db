//! Making a case small while it still shows what it shows.

use super::Case;

/// Drops and simplifies parts of a case as long as `fails` says that the rest still does. A case that can no longer be read at all
/// must not count as failing.
pub fn shrink(case: &Case, mut fails: impl FnMut(&Case) -> bool) -> Case {
    let mut best = case.clone();
    while let Some(smaller) = candidates(&best).into_iter().find(|c| fails(c)) {
        best = smaller;
    }
    best
}

/// Everything that is smaller by one step, the big steps first.
fn candidates(case: &Case) -> Vec<Case> {
    let mut all = Vec::new();
    if case.properties.len() > 1 {
        for n in 0..case.properties.len() {
            all.push(without(case, |c| drop(c.properties.remove(n))));
        }
    }
    let length = case.samples.len();
    let mut chunk = length / 2;
    while chunk > 0 {
        for start in (0..length).step_by(chunk) {
            all.push(without(case, |c| drop(c.samples.drain(start..(start + chunk).min(length)))));
        }
        chunk /= 2;
    }
    for n in 0..case.statements.len() {
        all.push(without(case, |c| drop(c.statements.remove(n))));
    }
    for (n, property) in case.properties.iter().enumerate() {
        for body in property.body.smaller() {
            all.push(without(case, |c| c.properties[n].body = body));
        }
    }
    if case.broke_off.is_some() {
        all.push(without(case, |c| c.broke_off = None));
    }
    all
}

fn without(case: &Case, change: impl FnOnce(&mut Case)) -> Case {
    let mut copy = case.clone();
    change(&mut copy);
    copy
}

#[cfg(test)]
mod tests {
    use super::super::generate;
    use super::*;

    #[test]
    fn what_does_not_matter_goes() {
        let case = generate(3, 30);
        let small = shrink(&case, |c| c.samples.len() >= 2);
        assert_eq!((small.samples.len(), small.properties.len(), small.statements.len()), (2, 1, 0));
        assert!(small.properties[0].body.smaller().is_empty());
    }
}
