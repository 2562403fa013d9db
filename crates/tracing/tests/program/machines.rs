//! A state diagram over what a program does.

use lapwing_tracing::{Handlers, Monitor};

use crate::robot::{kicker, sensor_controller};
use crate::support::{Counting, alone, said, same_as_checked, spec};

const TEXT: &str = "event kick = call Kicker::kick
machine ball {
    sample when updated(sonar) or kick
    initial away
    state gone on kick
    state near when sonar < 0.1
    state away when sonar >= 0.1
    away -> near
    near -> away | gone
    gone -> away
}
property near_first: always (entered(ball.gone) implies once entered(ball.near))
on violation of ball { run look  reset }
";

alone! {
    fn illegal_moves_are_answered_and_the_machine_starts_afresh() {
        let (tell, told) = std::sync::mpsc::channel();
        type Context = std::sync::Mutex<std::sync::mpsc::Sender<String>>;
        let look = |violation: &lapwing_tracing::Violation<'_>, tell: &Context| {
            tell.lock().expect("a sender").send(violation.to_string()).expect("someone listens");
        };
        let builder = Monitor::builder(spec(TEXT)).handlers(std::sync::Mutex::new(tell), Handlers::new().on("look", look));
        let monitor = builder.clock(Counting::default()).install().expect("a monitor");
        sensor_controller::set_sonar(0.5);
        kicker::kick("r1", 1.0);
        sensor_controller::set_sonar(0.05);
        kicker::kick("r1", 1.0);
        let report = monitor.finish();
        assert_eq!(told.try_iter().collect::<Vec<_>>(), ["robot.rv:2: ball is violated at 1 s: illegal transition away -> gone"]);
        // After the reset it stands in `away`, from which `near` is drawn.
        assert_eq!((said(&report, "ball").obligations.met, said(&report, "ball").obligations.failed), (2, 1));
    }

    fn without_a_reset_it_is_as_on_a_recording() {
        let text = TEXT.replace("on violation of ball { run look  reset }\n", "");
        let monitor = crate::support::watched(&text);
        sensor_controller::set_sonar(0.5);
        kicker::kick("r1", 1.0);
        sensor_controller::set_sonar(0.05);
        kicker::kick("r1", 1.0);
        let lines = "{\"t\": 0, \"values\": {\"sonar\": 0.5}}\n{\"t\": 1, \"event\": \"kick\"}\n\
                     {\"t\": 2, \"values\": {\"sonar\": 0.05}}\n{\"t\": 3, \"event\": \"kick\"}\n";
        same_as_checked(&monitor.finish(), &text, lines);
    }
}
