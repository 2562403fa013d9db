//! The command line of `monitor`: what is wrong is said before anything is watched.

use std::process::Command;

fn lapwing(arguments: &str) -> (i32, String) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("robot.rv"), SPEC).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_lapwing"));
    let output = command.args(arguments.split_whitespace()).current_dir(folder.path()).output().unwrap();
    (output.status.code().unwrap(), String::from_utf8(output.stderr).unwrap())
}

const SPEC: &str = "\
decl speed /speed Float64.data
calm: never speed > 2
on violation of calm { publish /brake std_msgs/Float64 { data: 0.25 } }
";

#[test]
fn what_does_not_go_together_is_said() {
    for (arguments, says) in [
        ("monitor robot.rv", "add --ros2"),
        ("monitor --ros2", "<SPEC.rv>"),
        ("monitor run.mcap --ros2", "no specification"),
        ("monitor none.rv --ros2", "no such file"),
        ("monitor robot.rv --ros1 http://:", "no address"),
        ("monitor robot.rv --ros2 --ros1", "cannot be used with"),
        ("monitor robot.rv --ros2 --serve nowhere", "--serve nowhere"),
        ("monitor robot.rv --ros2 --capsules here", "--record"),
        ("monitor robot.rv --ros1 http://127.0.0.1:9 --allow /other", "publishes /brake on violation of calm"),
    ] {
        let (code, said) = lapwing(arguments);
        assert!(code == 2 && said.contains(says), "{arguments}: {code}: {said}");
    }
}

#[test]
fn what_may_be_done_to_the_robot_is_said_first() {
    let (_, said) = lapwing("monitor robot.rv --ros1 http://127.0.0.1:9 --allow /other");
    assert!(said.contains("may publish /brake (std_msgs/Float64) by calm"), "{said}");
}
