//! Models in RT-BIP, from their text through a few steps.

use lapwing_bip::{Engine, FileId, Host, Model, Rules, Schedule, Scheduler, Standing, Value, check, parse, print};
use lapwing_diag::{SourceMap, Style, has_errors, render, render_short};
use std::sync::Arc;

/// Answers every call with something.
struct Anybody;

impl Host for Anybody {
    fn call(&mut self, function: u32, args: &mut [Value], _: Option<u32>) -> Result<Value, String> {
        args.iter_mut().filter(|a| a.as_int().is_some()).for_each(|a| *a = Value::Int(i64::from(function)));
        if function % 5 == 4 { Err("no answer".to_owned()) } else { Ok(Value::Int(i64::from(function))) }
    }
}

/// What is found can be shown; what is printed is read back and printed the same; what is right runs for a few steps, each of which is one that
/// was on offer.
pub fn bip(data: &[u8]) {
    let text = &*String::from_utf8_lossy(data);
    let mut sources = SourceMap::default();
    let file = sources.add("fuzz.bip", text);
    let parsed = parse(file, text);
    let checked = check(&parsed.package, &[]);
    for found in parsed.diagnostics.iter().chain(&checked.diagnostics) {
        let (start, end) = (found.primary.span.start as usize, found.primary.span.end as usize);
        assert!(text.get(start..end).is_some(), "{start}..{end} is no place in {text:?}");
        assert!(!render(&sources, found, Style::Plain).is_empty() && !render_short(&sources, found).is_empty());
    }
    if has_errors(&parsed.diagnostics) {
        return;
    }
    let printed = print(&parsed.package);
    let again = parse(FileId(0), &printed);
    assert!(!has_errors(&again.diagnostics), "what was printed is wrong: {printed}");
    assert_eq!(print(&again.package), printed, "printed otherwise the second time");
    if let Ok(model) = checked.model(None) {
        run_for_a_while(&Arc::new(model), text.len() as u64);
    }
}

fn run_for_a_while(model: &Arc<Model>, seed: u64) {
    let Ok(mut engine) = Engine::new(Arc::clone(model), Anybody, Rules::default()) else { return };
    let mut scheduler = Scheduler::new(Schedule::default(), seed);
    for _ in 0..100 {
        if engine.look() != Ok(Standing::Open) {
            return;
        }
        let (now, offers) = (engine.now(), engine.offers().to_vec());
        assert!(offers.iter().all(|o| !o.window.is_empty() && o.window.first >= now.0), "{offers:?} at {now}");
        let (id, at) = scheduler.choose(&engine).expect("one of those on offer");
        assert!(offers.iter().any(|o| o.id == id && o.window.holds(at.0)), "{at} is not on offer: {offers:?}");
        assert!(!engine.show_move(id).is_empty());
        if engine.make(id, at).is_err() || engine.settle(engine.now(), 0).is_err() {
            return;
        }
        assert!(engine.now() >= now, "time goes back");
    }
}
