//! An event that was warmed up allocates nothing.

use crate::robot::{kicker, sensor_controller};
use crate::support::{alone, watched};

const TEXT: &str = "event ready_true = return Kicker::ready when result == true
event ready_false = return Kicker::ready when result == false
event play = call Kicker::play
event kick = call Kicker::kick
event inner = set SensorController.sonar below Kicker::ball_in_front
event close = set SensorController.sonar when sonar < 0.1 below Kicker::ball_in_front
property init over (ready_true, ready_false, play): ltl([](play => <*> ready_true))
property soft over (kick, inner): always not (kick and kick.power > 9)
property named over (kick): always (kick implies kick.robot == \"r1\")
property close_at_kick over (inner, close, kick): ltl([](kick => <*> inner))
property until_kick: ltl([](play => o(close U kick)))
property sound: always sonar >= 0
";

fn round() {
    kicker::ready(true);
    kicker::play();
    kicker::ball_in_front(|| sensor_controller::set_sonar(0.05));
    kicker::kick("r1", 3.0);
}

alone! {
    fn nothing_is_allocated_after_warm_up() {
        let monitor = watched(TEXT);
        (0..5000).for_each(|_| round());
        let allocated = allocation_counter::measure(|| (0..5000).for_each(|_| round()));
        assert_eq!((allocated.count_total, allocated.bytes_total), (0, 0));
        let report = monitor.finish();
        assert!(report.properties.iter().all(|p| p.verdict.is_success()), "{:?}", report.properties);
        assert_eq!(report.properties[0].obligations.met, 20_000);
    }
}
