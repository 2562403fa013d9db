//! The examples of the language reference and of the first seed: all are right.

/// Every example.
pub const ALL: &[&str] = &[DECLARATIONS, EVENTS, FORMULAS, MACHINE, REACTIONS, SEED, EVALUATION];

const DECLARATIONS: &str = r#"
decl rotor1_vel /drone_mov/rotor1 Vector3.x               # name, topic, type and field path
decl rotor2_vel /drone_mov/rotor2 Vector3.x
decl cmd cmd_vel_original geometry_msgs/Twist.linear.x    # package may be given; topic needs no slash
decl nearest /scan LaserScan.ranges                       # arrays and structs are values too
model robot1:                                             # what the robot believes about itself
    position /odom Odometry.pose.pose.position
    ;
decl estop /estop Bool.data default false stale after 2 s
decl odom /odom Odometry
decl battery /battery BatteryState
decl joints /joint_states JointState
limit = 0.5 * 2                                           # a named expression
calm  = always robot1.velocity < limit                    # a named property
property no_rush: never robot1.velocity > 2.0             # the same, explicitly
"#;

const EVENTS: &str = r#"
event play        = call Kicker::play                       # before a function runs
event ready_true  = return Kicker::ready when result == true
event ir_read     = set SensorController.ball_dir_mod       # a field got a value
event inner       = set SensorController.sonar_read below Kicker::ball_in_front
event scan        = message /scan                           # a ROS message
event kicked      = message /kick std_msgs/Bool when data
event laser       = write LaserDriver.Laser
event asked       = request /set_mode
event replied     = reply /set_mode
event kick                                                  # an NDJSON or API event of that name
event ir_read_true
event ir_read_false
event game_over
property ir over (ir_read_true, ir_read_false): ltl([] ir_read_true)
property init: ltl([](play => <*> ready_true))
property heard over (ir_read, inner, scan, kicked, laser, asked, replied): always (asked implies eventually replied)
for each k of kick.robot: whenever kick, kick.power > 3
"#;

const FORMULAS: &str = r#"
whenever held for 0.5 s (cmd > 0.03), odom.twist.twist.linear.x > -0.01
always rotor1_vel =={0.1} rotor2_vel and not estop
whenever battery.power_supply_status == BatteryState.CHARGING, battery.voltage > 3
min(nearest) > 0.3
any(nearest, v => v < 1 m) implies fresh(/scan)
lookup(joints.name, joints.position, "elbow") < 1.5
age(/scan) < 500 ms
frequency(/scan, 2 s) > 5 Hz
norm(odom.twist.twist.linear) < 2 m/s
yaw(odom.pose.pose.orientation) < 90 deg
distance(odom.pose.pose.position, robot1.position) < 1 m
rate(cmd) < 1 m/s^2
@{robot1.position.x, -3} < 5
count(cmd > 1, 10 s) < 5 and mean_over(cmd, 5 s) < 1
odom.header.stamp > 0
for each r in (robot1, robot2): never r.velocity > 2
for each r in topics /{r}/odom: never r.velocity > 2
pattern tracks(command, response, tolerance, settle):
    whenever held for settle (delta(command) =={1e-6} 0), response =={tolerance} command
wheels: tracks(cmd, odom.twist.twist.linear.x, 0.05, 1 s)
pattern keeps_coming(signal, condition, max_gap):
    whenever condition and (signal or becomes condition), eventually within (0 s, max_gap] (signal or not condition)
keeps_coming(fresh(/scan), cmd > 0, 100 ms)
"#;

const MACHINE: &str = r#"
machine soccer {
    sample when (updated(sonar) and updated(ir_mod) and updated(ir_unmod)) or (updated(sonar) and sonar <= 0.07)
             or (updated(ir_mod) and ir_mod == 0) or (updated(ir_unmod) and ir_unmod == 0)
    initial init
    state turn_to_ball when not ball_in_front and not ball_close
    state goto_ball    when ball_in_front and not has_ball
    state game_over    on game_over
    else stay
    init -> turn_to_ball
    turn_to_ball -> goto_ball
    goto_ball -> turn_to_ball | game_over
}
whenever entered(soccer.goto_ball), eventually within 3 s left(soccer.goto_ball)
whenever soccer == goto_ball, not estop
"#;

const REACTIONS: &str = r#"
on violation of wheels at most every 1 s {
    publish /cmd_vel geometry_msgs/Twist { linear: { x: 0.0 }, angular: { z: 0.0 } }
    call /safety/stop std_srvs/Trigger {}
    request SafetyPilot.Stop
    run find_ball
    reset
    stop
}
guard /cmd_vel from /cmd_vel_raw by no_rush else drop
"#;

const SEED: &str = r#"
after robot.position.x > 1, never robot.velocity > 5
property1 = always robot.velocity > 1
until (robot1.position.x > 45 and robot1.position.y > 45), always (robot1.velocity > 1 implies robot2.distance.robot1 > 0.8)
never robot1.localization_error > 0.002
after_until drone.position.z > 5, drone.position.z < 5, rotor1_vel =={0.01} rotor2_vel
until turtlebot3_burger.position.x <= -1 and turtlebot3_burger.position.y < -1,
never turtlebot3_burger.velocity >= 0.1
after_until robot.distance.stop_sign < 1, robot.distance.stop_sign > 1, eventually robot.velocity =={0.01} 0
after robot.distance.wall < 1, never robot.velocity > 0.5
"#;

const EVALUATION: &str = r#"
decl angular_vel_robot_perception cmd_vel_original Twist.angular.z
after turtlebot3.velocity.angular.z < 0, never angular_vel_robot_perception > 0
decl vel_robot_perception cmd_vel_original Twist.linear.x
after vel_robot_perception > 0, never turtlebot3.velocity =={0.005} 0
after turtlebot3.velocity.linear.x < 0, never vel_robot_perception > 0
"#;
