//! Calls and returns: what `#[instrument]` says of a function, however it ends.

use std::panic::{AssertUnwindSafe, catch_unwind};

use futures::FutureExt;

use crate::robot::{kicker, rival};
use crate::support::{alone, cause, counting, said, same_as_checked, verdict, watched};

const INIT: &str = "event ready_true = return Kicker::ready when result == true
event ready_false = return Kicker::ready when result == false
event play = call Kicker::play
property init over (ready_true, ready_false, play): ltl([](play => <*> ready_true))
";

alone! {
    fn a_robot_that_is_ready_before_it_plays() {
        let monitor = watched(INIT);
        kicker::ready(false);
        kicker::ready(true);
        kicker::play();
        let report = monitor.finish();
        let lines = "{\"t\": 0, \"event\": \"ready_false\"}\n{\"t\": 1, \"event\": \"ready_true\"}\n{\"t\": 2, \"event\": \"play\"}\n";
        assert_eq!(verdict(&report, "init"), "holds");
        same_as_checked(&report, INIT, lines);
    }

    fn a_robot_that_is_not() {
        let monitor = watched(INIT);
        kicker::play();
        kicker::ready(true);
        kicker::play();
        let report = monitor.finish();
        let lines = "{\"t\": 0, \"event\": \"play\"}\n{\"t\": 1, \"event\": \"ready_true\"}\n{\"t\": 2, \"event\": \"play\"}\n";
        assert_eq!(verdict(&report, "init"), "violated");
        same_as_checked(&report, INIT, lines);
    }

    fn results_errors_and_arguments_are_fields() {
        let text = "event found = return Kicker::find_ball when result > 1
event lost = return Kicker::find_ball when error == \"no ball\"
event asked = call Kicker::find_ball
event kick = call Kicker::kick when power > 2 and robot == \"r1\"
property finds over (found, lost, asked, kick): always not lost
property order: whenever kick, previously found
";
        let monitor = watched(text);
        let _ = kicker::find_ball(Some(1.0));
        kicker::kick("r1", 3.0);
        kicker::kick("r1", 1.0);
        let _ = kicker::find_ball(None);
        kicker::kick("r1", 3.0);
        let report = monitor.finish();
        let lines = "{\"t\": 0, \"event\": \"asked\"}\n{\"t\": 1, \"event\": \"found\"}\n{\"t\": 2, \"event\": \"kick\"}\n\
                     {\"t\": 4, \"event\": \"asked\"}\n{\"t\": 5, \"event\": \"lost\"}\n{\"t\": 6, \"event\": \"kick\"}\n";
        assert_eq!((verdict(&report, "finds"), verdict(&report, "order")), ("violated", "violated"));
        // The kick that its condition hides has the stamp 3.
        same_as_checked(&report, text, lines);
    }

    fn a_panic_ends_a_function_without_a_return() {
        let text = "event grabs = call Kicker::grab
event grabbed = return Kicker::grab
always grabs or grabbed
property pairs: whenever grabs, next grabbed
";
        let monitor = watched(text);
        kicker::grab(Some(1.0));
        std::panic::set_hook(Box::new(|_| {}));
        assert!(catch_unwind(|| kicker::grab(None)).is_err());
        kicker::grab(Some(2.0));
        let report = monitor.finish();
        let lines = "{\"t\": 0, \"event\": \"grabs\"}\n{\"t\": 1, \"event\": \"grabbed\"}\n{\"t\": 2, \"event\": \"grabs\"}\n\
                     {\"t\": 3, \"event\": \"grabs\"}\n{\"t\": 4, \"event\": \"grabbed\"}\n";
        assert_eq!(verdict(&report, "pairs"), "violated");
        same_as_checked(&report, text, lines);
    }

    fn a_panic_that_is_caught_with_the_future_still_there_is_no_return() {
        let text = "event tries = call Kicker::try_to_grab
event tried = return Kicker::try_to_grab
always tries or tried
property pairs: whenever tries, next tried
";
        let monitor = watched(text);
        std::panic::set_hook(Box::new(|_| {}));
        let grab = |bearing| futures::executor::block_on(AssertUnwindSafe(kicker::try_to_grab(bearing)).catch_unwind());
        assert_eq!([grab(Some(1.0)).is_ok(), grab(None).is_ok(), grab(Some(2.0)).is_ok()], [true, false, true]);
        let report = monitor.finish();
        let line = |t: u32, event: &str| format!("{{\"t\": {t}, \"event\": \"{event}\"}}\n");
        let lines = [line(0, "tries"), line(1, "tried"), line(2, "tries"), line(3, "tries"), line(4, "tried")].concat();
        same_as_checked(&report, text, &lines);
    }

    fn a_panic_whose_span_somebody_keeps_is_no_return() {
        let text = "event plays = call Kicker::play_then
event played = return Kicker::play_then
always plays or played
property pairs: whenever plays, next played
";
        let monitor = watched(text);
        std::panic::set_hook(Box::new(|_| {}));
        let mut kept = None;
        let play = AssertUnwindSafe(|| {
            kicker::play_then(|| {
                kept = Some(tracing::Span::current());
                panic!("a foul");
            });
        });
        assert!(catch_unwind(play).is_err());
        drop(kept);
        kicker::play_then(|| {});
        let report = monitor.finish();
        assert_eq!(said(&report, "pairs").obligations.failed, 1);
    }

    fn a_function_that_clears_up_after_a_panic_returns() {
        struct StopsTheMotors;
        impl Drop for StopsTheMotors {
            fn drop(&mut self) {
                kicker::play();
            }
        }
        let text = "event plays = call Kicker::play
event played = return Kicker::play
property pairs: whenever plays, next played
";
        let monitor = watched(text);
        std::panic::set_hook(Box::new(|_| {}));
        let clears_up = || {
            let _stops = StopsTheMotors;
            panic!("a foul");
        };
        assert!(catch_unwind(clears_up).is_err());
        kicker::play();
        let report = monitor.finish();
        assert_eq!(said(&report, "pairs").obligations.failed, 0);
    }

    fn an_early_end_by_a_question_mark_is_no_return_with_a_result() {
        let text = "event asks = call Kicker::find_ball
event found = return Kicker::find_ball when result > -100
event failed = return Kicker::find_ball when error == \"no ball\"
property pairs over (asks, found): whenever asks, next found
property told over (asks, failed): whenever asks, next failed
";
        let monitor = watched(text);
        let _ = kicker::find_ball(Some(1.0));
        let _ = kicker::find_ball(None);
        let _ = kicker::find_ball(Some(2.0));
        let report = monitor.finish();
        // The second call asks, and the third is what comes next; the first and the third do not fail.
        assert_eq!((verdict(&report, "pairs"), verdict(&report, "told")), ("violated", "violated"));
        let (pairs, told) = (&said(&report, "pairs").obligations, &said(&report, "told").obligations);
        assert_eq!((pairs.failed, told.failed, told.open), (1, 1, 1));
    }

    fn a_future_that_is_dropped_has_not_returned_where_results_are_recorded() {
        let text = "event asks = call Kicker::await_ball
event done = return Kicker::await_ball
event found = return Kicker::await_ball when result > 0
property ends over (asks, done): whenever asks, next done
property finds over (asks, found): whenever asks, next found
";
        let monitor = watched(text);
        let runtime = tokio::runtime::Builder::new_current_thread().enable_time().build().expect("a runtime");
        let wait = |bearing| {
            let limit = std::time::Duration::from_millis(1);
            runtime.block_on(async { tokio::time::timeout(limit, kicker::await_ball(bearing)).await.is_ok() })
        };
        assert_eq!([Some(1.0), None, Some(1.0)].map(wait), [true, false, true]);
        let report = monitor.finish();
        // What comes after the second call is the third.
        let (ends, finds) = (said(&report, "ends"), said(&report, "finds"));
        assert_eq!((ends.verdict.word(), ends.obligations.failed), ("violated", 1), "{:?}", ends.cause);
        assert_eq!((finds.verdict.word(), finds.obligations.failed), ("violated", 1), "{:?}", finds.cause);
    }

    fn a_future_that_is_dropped_before_one_has_returned_cannot_be_judged() {
        let text = "event done = return Kicker::await_ball\nproperty never_done over (done): never done and done.robot == 1\n";
        let monitor = watched(text);
        assert!(kicker::await_ball(None).now_or_never().is_none());
        assert_eq!(futures::executor::block_on(kicker::await_ball(Some(1.0))), 1.0);
        let report = monitor.finish();
        assert_eq!(verdict(&report, "never_done"), "inconclusive");
        let cause = cause(&report, "never_done");
        assert!(cause.contains("a future of `Kicker::await_ball` was dropped before it was done"), "{cause}");
    }

    fn the_end_of_a_function_that_records_no_result_is_its_return() {
        let text = "event plays = call Kicker::play
event played = return Kicker::play
property pairs: whenever plays, next played
";
        let monitor = watched(text);
        kicker::play();
        kicker::play();
        let report = monitor.finish();
        let line = |t: u32, event: &str| format!("{{\"t\": {t}, \"event\": \"{event}\"}}\n");
        let lines = [line(0, "plays"), line(1, "played"), line(2, "plays"), line(3, "played")].concat();
        same_as_checked(&report, text, &lines);
        assert_eq!(said(&report, "pairs").obligations.met, 4);
    }

    fn a_result_that_is_not_recorded_cannot_be_judged() {
        let text = "event won = return Kicker::play when result == true\nevent plays = call Kicker::play\n\
                    property wins over (won, plays): always not won\n";
        let monitor = watched(text);
        kicker::play();
        let report = monitor.finish();
        assert_eq!(verdict(&report, "wins"), "inconclusive");
        assert!(cause(&report, "wins").contains("`#[instrument(ret)]` does"), "{}", cause(&report, "wins"));
        assert!(cause(&report, "wins").contains("its future was dropped"), "{}", cause(&report, "wins"));
    }

    fn two_functions_of_one_name_are_an_error() {
        let text = "event play = call Kicker::play\nevent ready = return Kicker::ready\n\
                    property calm: always not play\nproperty other: always not ready\n";
        let monitor = watched(text);
        rival::kicker::play();
        kicker::play();
        kicker::ready(true);
        let report = monitor.finish();
        // The first was taken for what was meant, since nobody could know of the second.
        assert_eq!(verdict(&report, "calm"), "violated");
        assert_eq!(said(&report, "calm").obligations.failed, 1);
        let text = "event play = call Kicker::play\nproperty once_at_most over (play): always (play implies not next play)\n";
        let monitor = counting(text).build().expect("a monitor");
        tracing::subscriber::with_default(registry_with(&monitor), || {
            rival::kicker::play();
            kicker::play();
            kicker::play();
        });
        let report = monitor.finish();
        assert_eq!(verdict(&report, "once_at_most"), "inconclusive");
        let cause = cause(&report, "once_at_most");
        assert!(cause.contains("rival::kicker::play") && cause.contains("say which by the modules"), "{cause}");
    }

    fn modules_tell_functions_of_one_name_apart() {
        let text = "event play = call rival::kicker::play\nproperty calm: always not play\n";
        let monitor = watched(text);
        kicker::play();
        rival::kicker::play();
        let report = monitor.finish();
        same_as_checked(&report, text, "{\"t\": 0, \"event\": \"play\"}\n");
    }

    fn what_is_called_alike_is_told_where_nothing_has_the_name() {
        let text = "event play = call Robot::play\nevent kick = call Kiker::kick\nevent read = set SensorControler.sonar\n\
                    event grab = call Arm::lift\n\
                    play_: never play\nkick_: never kick\nread_: never read\ngrab_: never grab\nalways soner < 1\nalways speed < 1\n";
        let monitor = watched(text);
        kicker::play();
        kicker::kick("r1", 1.0);
        crate::robot::sensor_controller::set_sonar(0.5);
        let report = monitor.finish();
        for (property, seen) in
            [("play_", "::robot::kicker::play`"), ("kick_", "::robot::kicker::kick`"), ("read_", "::robot::sensor_controller.sonar`")]
        {
            let cause = cause(&report, property);
            let hint = cause.rsplit("; ").next().unwrap_or("");
            assert!(hint.contains(seen) && hint.contains(" was seen (") && hint.contains("robot.rs:"), "{cause}");
        }
        assert!(cause(&report, "grab_").ends_with("turns it off"), "nothing is called like it: {}", cause(&report, "grab_"));
        let told: Vec<&str> = report.warnings.iter().map(|w| w.message.as_str()).collect();
        assert!(matches!(told[..], [one] if one.starts_with("no field `soner` was seen; `") && one.contains("sonar` was seen (")), "{told:?}");
    }

    fn what_was_never_reached_cannot_be_judged() {
        let text = "event play = call Kicker::play\nevent kick = call Kicker::kick\n\
                    property calm: always (play implies not kick)\nproperty plays: always not play\n";
        let monitor = watched(text);
        kicker::play();
        let report = monitor.finish();
        assert_eq!((verdict(&report, "calm"), verdict(&report, "plays")), ("inconclusive", "violated"));
        assert!(cause(&report, "calm").contains("no function `Kicker::kick` was seen"));

        let monitor = counting(text).assume_instrumented(["Kicker::kick"]).build().expect("a monitor");
        tracing::subscriber::with_default(registry_with(&monitor), kicker::play);
        assert_eq!(verdict(&monitor.finish(), "calm"), "holds");
    }
}

fn registry_with(monitor: &lapwing_tracing::Monitor) -> impl tracing::Subscriber + Send + Sync + use<> {
    use tracing_subscriber::layer::SubscriberExt;
    tracing_subscriber::registry().with(monitor.layer())
}
