//! When a monitor of JavaMOP begins: at the first of its events, at one that is marked `creation`, or, where it is a `suffix` monitor, at every event
//! anew.
//!
//! Each of these is an automaton over the whole run: the one that was written, with what it does before it begins.

use std::collections::{BTreeMap, BTreeSet};

use super::automaton::{Automaton, MOST_STATES};

/// How long a name of several states may be.
const MOST_NAME: usize = 40;

/// The automaton that stays where it begins until one of the letters comes that are `creating`, and its targets. `None` where nothing changes: it begins
/// with any letter, or stays there anyway.
pub(super) fn at_creation(
    of: &Automaton,
    targets: &BTreeSet<usize>,
    creating: &[bool],
) -> Option<(Automaton, BTreeSet<usize>)> {
    let first = of.next.first()?;
    let moves = |(to, creates): (&usize, &bool)| !creates && *to != 0;
    if !creating.contains(&true) || !first.iter().zip(creating).any(moves) {
        return None;
    }
    let waiting = first.iter().zip(creating).map(|(to, creates)| if *creates { to + 1 } else { 0 }).collect();
    let begun = of.next.iter().map(|row| row.iter().map(|to| to + 1).collect());
    let states = ["waiting".to_owned()].into_iter().chain(of.states.iter().cloned()).collect();
    let next = [waiting].into_iter().chain(begun).collect();
    Some((Automaton { states, next }, targets.iter().map(|t| t + 1).collect()))
}

/// The automaton that enters its target when one begun at any of the letters enters one of `targets`. Its states are sets of states, one of each that has
/// begun and may still come to a target. `None` where there are too many.
pub(super) fn at_every_event(of: &Automaton, targets: &BTreeSet<usize>) -> Option<(Automaton, BTreeSet<usize>)> {
    const TARGET: usize = 1;
    let letters = of.next.first().map_or(0, Vec::len);
    let hopeful = leading_to(of, targets);
    let start = BTreeSet::from([0]);
    let mut known = BTreeMap::from([(start.clone(), 0)]);
    let mut states = vec![name_of(of, &start), "target".to_owned()];
    let mut next = vec![Vec::new(), vec![0; letters]];
    let mut open = vec![(start, 0)];
    while let Some((set, number)) = open.pop() {
        for letter in 0..letters {
            let after: BTreeSet<usize> = set.iter().filter_map(|s| of.next.get(*s)?.get(letter).copied()).collect();
            let to = if after.is_disjoint(targets) {
                // Whatever comes next begins another one.
                let set: BTreeSet<usize> = after.intersection(&hopeful).copied().chain([0]).collect();
                *known.entry(set).or_insert_with_key(|set| {
                    open.push((set.clone(), states.len()));
                    states.push(name_of(of, set));
                    next.push(Vec::new());
                    states.len() - 1
                })
            } else {
                TARGET
            };
            next.get_mut(number)?.push(to);
        }
        if states.len() > MOST_STATES {
            return None;
        }
    }
    Some((Automaton { states, next }, BTreeSet::from([TARGET])))
}

/// The states from which a target can be entered.
fn leading_to(of: &Automaton, targets: &BTreeSet<usize>) -> BTreeSet<usize> {
    let mut found = BTreeSet::new();
    loop {
        let leads = |row: &Vec<usize>| row.iter().any(|to| targets.contains(to) || found.contains(to));
        let more: BTreeSet<usize> = (0..of.next.len()).filter(|s| of.next.get(*s).is_some_and(leads)).collect();
        if more == found {
            return found;
        }
        found = more;
    }
}

/// A name for a set of states; the beginning, which is in each of them, is named only where it is alone.
fn name_of(of: &Automaton, set: &BTreeSet<usize>) -> String {
    let name = |s: &usize| of.states.get(*s).map_or("", String::as_str);
    let others: Vec<&str> = set.iter().filter(|s| **s != 0).map(name).collect();
    let joined = if others.is_empty() { name(&0).to_owned() } else { others.join("_") };
    if joined.len() > MOST_NAME { "several".to_owned() } else { joined }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether the automaton, from its beginning, enters one of the targets at the last letter of a word and not before.
    fn enters(of: &Automaton, targets: &BTreeSet<usize>, word: &[usize]) -> bool {
        let mut state = 0;
        for (at, letter) in word.iter().enumerate() {
            state = of.next[state][*letter];
            if targets.contains(&state) {
                return at + 1 == word.len();
            }
        }
        false
    }

    fn words(letters: usize, length: usize) -> Vec<Vec<usize>> {
        let mut all = vec![Vec::new()];
        let mut last = all.clone();
        for _ in 0..length {
            last = last.iter().flat_map(|w| (0..letters).map(|l| [&w[..], &[l]].concat())).collect();
            all.extend(last.clone());
        }
        all
    }

    /// `0 1 0` matches; anything else leads where nothing matches any more.
    fn zigzag() -> (Automaton, BTreeSet<usize>) {
        let states = ["start", "a", "ab", "done", "lost"].map(str::to_owned).to_vec();
        (
            Automaton { states, next: vec![vec![1, 4], vec![4, 2], vec![3, 4], vec![4, 4], vec![4, 4]] },
            BTreeSet::from([3]),
        )
    }

    #[test]
    fn a_suffix_monitor_enters_its_target_when_one_begun_anywhere_does() {
        let (of, targets) = zigzag();
        let (anew, entered) = at_every_event(&of, &targets).unwrap();
        assert_eq!(anew.states, ["start", "target", "a", "ab"]);
        for word in words(2, 7) {
            let hit = |word: &[usize]| (0..word.len()).any(|from| enters(&of, &targets, &word[from..]));
            let first = hit(&word) && !(1..word.len()).any(|to| hit(&word[..to]));
            assert_eq!(enters(&anew, &entered, &word), first, "{word:?}");
        }
    }

    #[test]
    fn nothing_is_seen_before_a_letter_that_creates() {
        let (of, targets) = zigzag();
        let (late, entered) = at_creation(&of, &targets, &[true, false]).unwrap();
        for word in words(2, 7) {
            let from = word.iter().position(|l| *l == 0).unwrap_or(word.len());
            assert_eq!(enters(&late, &entered, &word), enters(&of, &targets, &word[from..]), "{word:?}");
        }
        assert!(at_creation(&of, &targets, &[true, true]).is_none());
        assert!(at_creation(&of, &targets, &[false, false]).is_none());
    }

    #[test]
    fn sets_that_explode_are_refused() {
        // The seventh letter from the end is a 0: sets remember seven letters.
        let states = (0..9).map(|n| format!("s{n}")).collect();
        let mut next: Vec<Vec<usize>> = (0..9).map(|n: usize| vec![(n + 1).min(8); 2]).collect();
        next[0] = vec![1, 8];
        assert!(at_every_event(&Automaton { states, next }, &BTreeSet::from([8])).is_some());
        let states = (0..9).map(|n| format!("s{n}")).collect();
        let mut next: Vec<Vec<usize>> = (0..9).map(|n: usize| vec![n + 1, n + 1, n + 1]).collect();
        next[0] = vec![1, 8, 8];
        next[6] = vec![8, 8, 7];
        next[7] = vec![8; 3];
        next[8] = vec![8; 3];
        assert!(at_every_event(&Automaton { states, next }, &BTreeSet::from([7])).is_none());
    }
}
