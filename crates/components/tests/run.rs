//! What components do: activities, locks, exceptions, requests, time.

mod common;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};

use common::{all, all_real, count, lines, millis, model, setup, start};
use lapwing_components::{Answer, Call, Codels, Datum, Happening, Observer, Outcome, Run, Setup, TroubleKind, What};
use lapwing_stream::Duration;

/// A task that counts, and publishes what it has counted; another that reads it.
const COUNTER: &str = "
component Counter {
  exception TOO_FAR, NEVER;
  ids { long n; long most; };
  port out long N;
  attribute SetMost(in most = 3);
  attribute Get(out n);
  function Add(in long by, out long now) {
    validate Check(local in by);
    codel AddUp(local in by, ids inout n, local out now);
    throw TOO_FAR;
  };
  task t { period 10 ms; };
  activity Count() {
    task t;
    codel<start> Begin(ids out n) yield step wcet 1 ms;
    codel<step> Step(ids inout n, ids in most, port out N) yield pause::step, ether wcet 2 ms;
    codel<stop> Stop(port out N) yield ether wcet 1 ms;
    throw TOO_FAR;
    interrupts Count;
  };
};
component Reader {
  ids { long seen; };
  port in long N;
  task u { period 20 ms; };
  activity Read() {
    task u;
    codel<start> Look(port in N, ids out seen) yield pause::start wcet 1 ms;
  };
};
";

fn counting() -> Codels {
    Codels::new()
        .on("Counter", "Begin", |call: &mut Call| {
            call.set("n", 0_i64)?;
            Ok(Answer::event("step"))
        })
        .on("Counter", "Step", |call: &mut Call| {
            let n = call.number("n")? as i64 + 1;
            call.set("n", n)?;
            call.set("N", n)?;
            call.write("N")?;
            if n as f64 > call.number("most")? {
                return Ok(Answer::exception("TOO_FAR"));
            }
            Ok(Answer::event("pause::step"))
        })
        .on("Counter", "Stop", |call: &mut Call| {
            call.set("N", -1_i64)?;
            call.write("N")?;
            Ok(Answer::event("ether"))
        })
        .on("Counter", "Check", |call: &mut Call| {
            Ok(if call.number("by")? > 9.0 { Answer::exception("TOO_FAR") } else { Answer::Ok })
        })
        .on("Counter", "AddUp", |call: &mut Call| {
            let sum = call.number("n")? + call.number("by")?;
            call.set("n", sum as i64)?;
            call.set("now", sum as i64)?;
            Ok(Answer::Ok)
        })
        .on("Reader", "Look", |call: &mut Call| {
            if call.has("N") {
                call.copy("N", "seen")?;
            }
            Ok(Answer::event("pause::start"))
        })
}

#[test]
fn codels_share_data_and_ports_and_an_exception_ends_their_activity() {
    let (model, sources) = model(COUNTER);
    let mut run = start(
        &model,
        setup(200),
        counting(),
        "@0s Counter.SetMost(most=5)\n@1ms Counter.Count()\n@1ms Reader.Read()\n",
    );
    let said = lines(&mut run, &sources).join("\n");
    assert!(said.contains("report #1 Counter.SetMost done (most=5)"), "{said}");
    assert!(
        said.contains("end Counter.Count (1) TOO_FAR") && said.contains("report #2 Counter.Count TOO_FAR ()"),
        "{said}"
    );
    assert_eq!(said.matches("write Counter.N").count(), 6, "{said}");
    assert_eq!(run.ids("Reader", "seen"), Some(Datum::Int(6)));
    assert_eq!(run.figures().all_missed(), 0);
}

#[test]
fn the_same_seed_gives_the_same_lines_and_another_gives_others() {
    let (model, sources) = model(COUNTER);
    let run = |seed| {
        let setup = Setup { seed, ..setup(500) };
        lines(&mut start(&model, setup, Codels::new(), "@0s Counter.Count()\n@0s Reader.Read()\n"), &sources)
    };
    assert_eq!(run(1), run(1));
    assert_ne!(run(1), run(2));
}

#[test]
fn an_interrupted_activity_stops_and_the_new_one_waits_for_that() {
    let (model, sources) = model(COUNTER);
    let requests = "@0s Counter.SetMost(most=100)\n@1ms Counter.Count()\n@45ms Counter.Count()\n";
    let said = lines(&mut start(&model, setup(100), counting(), requests), &sources);
    let at = |what: &str| said.iter().position(|l| l.contains(what)).unwrap_or_else(|| panic!("{what}: {said:#?}"));
    assert!(at("interrupt Counter.Count (1)") < at("call Counter.Count.stop Stop"));
    assert!(at("end Counter.Count (1) interrupted") < at("start Counter.Count (2)"));
    assert!(at("report #2 Counter.Count interrupted") < at("start Counter.Count (2)"));
    assert!(said.iter().any(|l| l.contains("write Counter.N -1")), "{said:#?}");
}

#[test]
fn what_runs_before_its_first_turn_and_is_interrupted_runs_stop() {
    let (model, sources) = model(COUNTER);
    let said =
        lines(&mut start(&model, setup(50), counting(), "@1ms Counter.Count()\n@2ms Counter.Count()\n"), &sources);
    let said = said.join("\n");
    assert!(
        said.contains("call Counter.Count.stop Stop") && said.contains("end Counter.Count (1) interrupted"),
        "{said}"
    );
}

#[test]
fn requests_are_refused_by_validate_and_where_there_is_no_instance() {
    let (model, sources) = model(COUNTER);
    let requests = "@0s Counter.Add(by=10)\n@1ms Counter.Add(4)\n@2ms Counter.Get()\n@3ms Reader.Read()\n@3ms Reader.Read()\n@3ms Reader.Read()\n";
    let said = lines(&mut start(&model, setup(50), counting(), requests), &sources).join("\n");
    assert!(said.contains("reply #1 Counter.Add refused: TOO_FAR"), "{said}");
    assert!(said.contains("report #2 Counter.Add done (by=4, now=4)"), "{said}");
    assert!(said.contains("report #3 Counter.Get done (n=4)"), "{said}");
    assert!(said.contains("reply #6 Reader.Read refused: too_many_activities"), "{said}");
}

#[test]
fn a_service_after_another_is_disallowed_before_its_success() {
    let (model, sources) = model(
        "component C { task t { period 10 ms; };
           function Init() {};
           activity Go() { task t; codel<start> Run() yield ether wcet 1 ms; after Init; };
         };",
    );
    let said =
        lines(&mut start(&model, setup(100), Codels::new(), "@0s C.Go()\n@1ms C.Init()\n@2ms C.Go()\n"), &sources);
    let said = said.join("\n");
    assert!(said.contains("reply #1 C.Go refused: disallowed") && said.contains("report #3 C.Go done"), "{said}");
}

#[test]
fn what_a_codel_does_not_declare_ends_its_activity() {
    let (model, sources) = model(COUNTER);
    let wrong = |answer: Answer| counting().on("Counter", "Step", move |_: &mut Call| Ok(answer.clone()));
    for (answer, words) in [
        (Answer::event("nowhere"), "bad_transition (nowhere)"),
        (Answer::exception("NEVER"), "bad_transition (NEVER)"),
        (Answer::Ok, "bad_transition (ok)"),
    ] {
        let said = lines(&mut start(&model, setup(50), wrong(answer), "@1ms Counter.Count()\n"), &sources).join("\n");
        assert!(said.contains(&format!("report #1 Counter.Count {words}")), "{said}");
    }
}

/// Two tasks that use the same data, one of them slowly.
const SHARED: &str = "
component C {
  ids { long x; };
  task a { period 10 ms; };
  task b { period 10 ms; };
  activity A() { task a; codel<start> Slow(ids inout x) yield pause::start wcet 8 ms; };
  activity B() { task b; codel<start> Quick(ids inout x) yield pause::start wcet 1 ms; };
};
";

#[test]
fn a_lock_is_held_until_its_codel_has_ended() {
    let (model, _) = model(SHARED);
    let happened = all(&mut start(&model, setup(2000), Codels::new(), "@0s C.A()\n@0s C.B()\n"));
    let (mut inside, mut calls) = (0, 0);
    for happening in &happened {
        match happening.what {
            What::Called { codel, .. } if codel.0 < 2 => (inside, calls) = (inside + 1, calls + 1),
            What::Returned { codel, .. } if codel.0 < 2 => inside -= 1,
            _ => {}
        }
        assert!(inside <= 1, "two codels that share data run at {}", happening.time);
    }
    assert!(calls > 300, "{calls}");
}

#[test]
fn a_codel_that_is_too_slow_is_counted_and_so_are_the_turns_that_it_costs() {
    let (model, sources) = model(SHARED);
    let slow = Codels::new().on("C", "Slow", |call: &mut Call| {
        call.take(millis(25));
        Ok(Answer::event("pause::start"))
    });
    let mut run = start(&model, setup(200), slow, "@0s C.A()\n");
    let said = lines(&mut run, &sources).join("\n");
    assert!(said.contains("overrun C.A.start Slow took ") && said.contains("(t.gen:6)"), "{said}");
    assert!(said.contains("missed C.a: ") && said.contains("late C.a: "), "{said}");
    let figures = run.figures();
    let (overruns, missed) = (figures.overruns.values().map(|c| c.times).sum::<u64>(), figures.all_missed());
    assert!(overruns >= 5 && missed >= 8 && figures.late.values().all(|l| l.times >= 5), "{overruns} {missed}");
}

#[test]
fn an_async_codel_runs_beside_its_task() {
    let (model, _) = model(
        "component C {
           task t { period 10 ms; };
           activity Long() { task t; async codel<start> Think() yield ether wcet 55 ms; };
           activity Short() { task t; codel<start> Tick() yield pause::start wcet 1 ms; };
         };",
    );
    let think = Codels::new().on("C", "Think", |call: &mut Call| {
        call.take(millis(40));
        Ok(Answer::event("ether"))
    });
    let happened = all(&mut start(&model, setup(200), think, "@0s C.Long()\n@0s C.Short()\n"));
    let at = |is_it: &dyn Fn(&What) -> bool| happened.iter().position(|h| is_it(&h.what)).unwrap();
    let began = at(&|w| matches!(w, What::Called { codel, .. } if codel.0 == 0));
    let ended = at(&|w| matches!(w, What::Returned { codel, .. } if codel.0 == 0));
    let between = count(&happened[began..ended], |w| matches!(w, What::Called { codel, .. } if codel.0 == 1));
    assert!(between >= 4, "the task had {between} turns meanwhile");
    assert!(count(&happened, |w| matches!(w, What::Reported { outcome: Outcome::Done, .. })) == 1);
}

#[test]
fn a_task_without_a_period_wakes_for_its_activities() {
    let (model, sources) = model(
        "component C {
           task t { period 10 ms; };
           task e {};
           activity Wait() { task e; codel<start> W1() yield pause::next wcet 1 ms; codel<next> W2() yield ether wcet 1 ms; };
           activity Do() { task t; codel<start> D1() yield next wcet 1 ms; codel<next> D2() yield ether wcet 1 ms; };
         };",
    );
    let said =
        lines(&mut start(&model, setup(100), Codels::new(), "@1ms C.Wait()\n@40ms C.Do()\n"), &sources).join("\n");
    assert!(said.contains("start C.Wait") && said.contains("report #1 C.Wait done"), "{said}");
}

#[test]
fn permanent_activities_begin_one_after_the_other_and_before_requests() {
    let (model, sources) = model(
        "component C {
           task a { period 10 ms; codel<start> A1() yield main wcet 5 ms; codel<main> A2() yield pause::main wcet 1 ms; };
           task b { period 10 ms; codel<start> B1() yield main wcet 5 ms; codel<main> B2() yield pause::main wcet 1 ms; };
           function F() {};
         };",
    );
    let said = lines(&mut start(&model, setup(60), Codels::new(), "@0s C.F()\n"), &sources);
    let at = |what: &str| said.iter().position(|l| l.contains(what)).unwrap_or_else(|| panic!("{what}: {said:#?}"));
    assert!(at("return C.a.start A1") < at("call C.b.start B1"), "{said:#?}");
    assert!(at("return C.b.start B1") < at("reply #1 C.F accepted"), "{said:#?}");
    assert!(said.iter().filter(|l| l.contains("call C.b.main B2")).count() >= 4, "{said:#?}");
}

#[test]
fn in_real_time_tasks_run_at_the_same_time_and_come_as_often_as_they_should() {
    let (model, _) = model(COUNTER);
    let setup = Setup { is_real: true, ..setup(400) };
    let requests = "@0s Counter.SetMost(most=5)\n@1ms Counter.Count()\n@1ms Reader.Read()\n";
    let (run, happened) = all_real(start(&model, setup, counting(), requests));
    // However slow the machine is: the order is this, and the counting ends where it should.
    let writes: Vec<f64> = happened
        .iter()
        .filter_map(|h| match &h.what {
            What::Written { value, .. } => value.number(),
            _ => None,
        })
        .collect();
    assert_eq!(writes, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    assert!(happened.windows(2).all(|two| two[0].time <= two[1].time));
    assert_eq!(run.ids("Counter", "n"), Some(Datum::Int(6)));
}

#[test]
fn in_real_time_an_observer_that_panics_ends_the_run() {
    let (model, _) = model(COUNTER);
    for wanted in ["first request", "first codel"] {
        let run = start(
            &model,
            Setup { is_real: true, duration: None, ..Setup::default() },
            counting(),
            "@0s Counter.Count()\n",
        );
        let panics = move |_: &mut Run, happening: &Happening| match happening.what {
            What::Requested { .. } if wanted == "first request" => panic!("the observer has had enough"),
            What::Returned { .. } if wanted == "first codel" => panic!("the observer has had enough"),
            _ => {}
        };
        assert!(catch_unwind(AssertUnwindSafe(|| run.carry_out(panics))).is_err(), "{wanted}");
    }
}

/// Ends a run after so many reports.
struct Reports {
    wanted: usize,
    seen: usize,
}

impl Observer for Reports {
    fn see(&mut self, run: &mut Run, happening: &Happening) {
        assert!(!matches!(happening.what, What::Failed(_)), "{happening:?}");
        self.seen += usize::from(matches!(happening.what, What::Reported { .. }));
        if self.seen == self.wanted {
            run.stop();
        }
    }
}

#[test]
fn in_real_time_two_tasks_do_not_wait_for_each_other() {
    let (model, _) = model(
        "component C {
           task a { period 10 ms; };
           task b { period 10 ms; };
           activity A() { task a; codel<start> Meet() yield ether wcet 1 s; };
           activity B() { task b; codel<start> Meet() yield ether wcet 1 s; };
         };",
    );
    // Each waits until the other one is there as well: one thread alone would never return.
    let barrier = Arc::new(std::sync::Barrier::new(2));
    let meet = Codels::new().on("C", "Meet", move |_: &mut Call| {
        barrier.wait();
        Ok(Answer::event("ether"))
    });
    let setup = Setup { is_real: true, duration: None, ..Setup::default() };
    let run = start(&model, setup, meet, "@0s C.A()\n@0s C.B()\n");
    let (_, two) = run.carry_out(Reports { wanted: 2, seen: 0 });
    assert_eq!(two.seen, 2);
}

#[test]
fn a_codel_that_panics_or_hangs_ends_the_run_with_its_name() {
    let (model, sources) = model(COUNTER);
    let panics = counting().on("Counter", "Step", |_: &mut Call| panic!("no more numbers"));
    let said = lines(&mut start(&model, setup(100), panics, "@0s Counter.Count()\n"), &sources).join("\n");
    assert!(said.contains("failure Counter.Count.step Step (t.gen:17): it panicked: no more numbers"), "{said}");

    let release = Arc::new(Mutex::new(()));
    let held = release.lock().unwrap();
    let waits = release.clone();
    let hangs = counting().on("Counter", "Step", move |_: &mut Call| {
        drop(waits.lock());
        Ok(Answer::event("ether"))
    });
    let setup = Setup { is_real: true, duration: None, patience: millis(50), ..Setup::default() };
    let (_, happened) = all_real(start(&model, setup, hangs, "@0s Counter.Count()\n"));
    drop(held);
    let failed = happened.iter().find_map(|h| match &h.what {
        What::Failed(failure) => Some(failure.trouble.kind),
        _ => None,
    });
    assert_eq!(failed, Some(TroubleKind::Hung));
}

#[test]
fn a_codel_that_asks_for_what_it_is_not_given_is_told_what_it_is() {
    let (model, sources) = model(COUNTER);
    let asks = counting().on("Counter", "Step", |call: &mut Call| {
        call.number("m")?;
        Ok(Answer::event("ether"))
    });
    let said = lines(&mut start(&model, setup(100), asks, "@0s Counter.Count()\n"), &sources).join("\n");
    assert!(said.contains("`Step` asked for `m`: the codel is given `n`, `most`, `N`"), "{said}");
    let writes = counting().on("Counter", "Step", |call: &mut Call| {
        call.set("most", 1_i64)?;
        Ok(Answer::event("ether"))
    });
    let said = lines(&mut start(&model, setup(100), writes, "@0s Counter.Count()\n"), &sources).join("\n");
    assert!(said.contains("it is `in`, and only to be read"), "{said}");
}

#[test]
fn other_threads_ask_for_services_while_a_run_goes_on() {
    let (model, _) = model(COUNTER);
    let setup = Setup { is_real: true, duration: None, ..Setup::default() };
    let run = start(&model, setup, counting(), "");
    let client = run.client().unwrap();
    let request = run.plain_request("Counter.Get").unwrap();
    let asked = Arc::new(AtomicUsize::new(0));
    let count = asked.clone();
    let thread = std::thread::spawn(move || {
        for _ in 0..3 {
            assert!(client.request(request.clone()));
            count.fetch_add(1, Ordering::SeqCst);
        }
        client
    });
    let (_, three) = run.carry_out(Reports { wanted: 3, seen: 0 });
    drop(thread.join().unwrap());
    assert_eq!((three.seen, asked.load(Ordering::SeqCst)), (3, 3));
}

#[test]
fn without_an_end_a_run_in_which_nothing_is_due_is_over() {
    let (model, _) = model("component C { function F() {}; };");
    let setup = Setup { duration: None, ..Setup::default() };
    let mut run = start(&model, setup, Codels::new(), "@1s C.F()\n");
    let happened = all(&mut run);
    assert!(matches!(happened.last().map(|h| &h.what), Some(What::Over)));
    assert_eq!(Duration::from_nanos(run.now().0), millis(1000));
}

#[test]
fn a_service_is_found_whatever_it_and_the_others_are_called() {
    // The control task has an edge `request_Foo_manage` for the one activity before it has that for requests of the function.
    let (model, sources) = model(
        "component C {
           task t { period 10 ms; };
           activity request_Foo() { task t; codel<start> S() yield ether wcet 1 ms; };
           function Foo_manage() {};
         };",
    );
    let mut run = start(&model, setup(100), Codels::new(), "@0s C.Foo_manage()\n@0s C.request_Foo()\n");
    let said = lines(&mut run, &sources).join("\n");
    for wanted in ["report #1 C.Foo_manage done", "report #2 C.request_Foo done"] {
        assert!(said.contains(wanted), "{wanted}: {said}");
    }
}
