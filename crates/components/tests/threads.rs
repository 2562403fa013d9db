//! Which threads call codels in real time.

mod common;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex};
use std::thread::{self, ThreadId};
use std::time::Duration;

use common::{all_real, count, model, setup, start};
use lapwing_components::{Answer, Call, Codels, Setup, What};

/// Components in a row, each with a task of 5 ms.
const TASKS: usize = 4;

const REQUESTS: &str = "@0s C0.Go()\n@0s C1.Go()\n@0s C2.Go()\n@0s C3.Go()\n";

fn components() -> String {
    let one = |n: usize| {
        format!(
            "component C{n} {{ task t {{ period 5 ms; }};
               activity Go() {{ task t; codel<start> Step{n}() yield pause::start; }}; }};\n"
        )
    };
    (0..TASKS).map(one).collect()
}

/// By task: the threads that have called its codel.
type Callers = Arc<Mutex<BTreeMap<usize, Vec<ThreadId>>>>;

fn codels(callers: &Callers) -> Codels {
    (0..TASKS).fold(Codels::new(), |all, n| {
        let callers = callers.clone();
        all.on(&format!("C{n}"), &format!("Step{n}"), move |_: &mut Call| {
            callers.lock().unwrap().entry(n).or_default().push(thread::current().id());
            Ok(Answer::event("pause::start"))
        })
    })
}

fn callers(own_threads: bool) -> BTreeMap<usize, BTreeSet<String>> {
    let (model, _) = model(&components());
    let callers = Callers::default();
    let setup = Setup { is_real: true, own_threads, ..setup(1000) };
    all_real(start(&model, setup, codels(&callers), REQUESTS));
    let all = callers.lock().unwrap();
    all.iter().map(|(task, threads)| (*task, threads.iter().map(|t| format!("{t:?}")).collect())).collect()
}

#[test]
fn codels_that_return_at_once_are_called_by_whoever_is_awake() {
    let callers = callers(false);
    assert_eq!(callers.len(), TASKS);
    let threads: Vec<&String> = callers.values().flatten().collect();
    let apart: BTreeSet<&&String> = threads.iter().collect();
    assert!(apart.len() < threads.len(), "no thread has called codels of two tasks: {callers:?}");
}

#[test]
fn where_every_task_has_a_thread_of_its_own_nobody_else_calls_its_codels() {
    let callers = callers(true);
    assert_eq!(callers.len(), TASKS);
    let all: Vec<&String> = callers.values().flatten().collect();
    assert_eq!(all.len(), TASKS, "{callers:?}");
    assert_eq!(all.iter().collect::<BTreeSet<_>>().len(), TASKS, "{callers:?}");
}

/// A codel that has returned at once for long waits for those that were due with it. Were it alone to call them, they would never come.
#[test]
fn a_codel_that_once_takes_its_time_holds_up_nobody() {
    let (model, _) = model(&components());
    let others = Arc::new((Mutex::new(0_u64), Condvar::new()));
    let turns = Arc::new(AtomicU64::new(0));
    let mut all = Codels::new();
    for n in 1..TASKS {
        let others = others.clone();
        all = all.on(&format!("C{n}"), &format!("Step{n}"), move |_: &mut Call| {
            *others.0.lock().unwrap() += 1;
            others.1.notify_all();
            Ok(Answer::event("pause::start"))
        });
    }
    let waits = move |_: &mut Call| {
        let turn = turns.fetch_add(1, Ordering::Relaxed);
        if turn % 40 == 39 {
            let seen = others.0.lock().unwrap();
            let wanted = *seen + 3 * TASKS as u64;
            let (seen, _) = others.1.wait_timeout_while(seen, Duration::from_secs(20), |seen| *seen < wanted).unwrap();
            assert!(*seen >= wanted, "the others have not come");
        }
        Ok(Answer::event("pause::start"))
    };
    let all = all.on("C0", "Step0", waits);
    let setup = Setup { is_real: true, patience: common::millis(60_000), ..setup(1000) };
    let (_, happened) = all_real(start(&model, setup, all, REQUESTS));
    let failures: Vec<&What> = happened.iter().map(|h| &h.what).filter(|w| matches!(w, What::Failed(_))).collect();
    assert!(failures.is_empty(), "{failures:?}");
    assert!(count(&happened, |w| matches!(w, What::Returned { component: 0, .. })) > 40);
}
