#!/bin/sh
# Other people's tools, for the tests that compare ours with theirs (crates/record/tests/others.rs) and for those that talk to them
# (crates/ros/tests/ros1).
#
# Makes .venv beside this folder's parent with rosbags and mcap, and installs ROS 1's own rosbag, rospy and master from the distribution.
# Does only what is missing: a second run takes no time.
set -eu

cd "$(dirname "$0")/.."

python_packages='rosbags==0.11.* mcap mcap-ros2-support protobuf websockets'
ros1_packages='ros-core python3-rosbag python3-genpy python3-rospy python3-rosmaster python3-rostopic python3-std-msgs python3-geometry-msgs python3-nav-msgs
    python3-sensor-msgs python3-std-srvs python3-actionlib-msgs python3-diagnostic-msgs python3-rosgraph-msgs python3-tf2-msgs python3-trajectory-msgs'

if [ ! -x .venv/bin/python ]; then
    python3 -m venv .venv
fi
if ! .venv/bin/python -c 'import rosbags.rosbag2, rosbags.rosbag1, mcap.writer, mcap_ros2.writer, google.protobuf.message_factory, websockets.sync.client' 2>/dev/null; then
    # shellcheck disable=SC2086  # one word per package is meant
    .venv/bin/pip install --quiet $python_packages
fi

ros1_modules='rosbag, rospy, rosmaster, rostopic, nav_msgs.msg, sensor_msgs.msg, std_srvs.srv, actionlib_msgs.msg, diagnostic_msgs.msg, rosgraph_msgs.msg, tf2_msgs.msg, trajectory_msgs.msg'
if ! /usr/bin/python3 -c "import $ros1_modules" 2>/dev/null; then
    if [ "$(id -u)" -eq 0 ]; then run=; else run=sudo; fi
    $run apt-get update -qq
    # shellcheck disable=SC2086
    DEBIAN_FRONTEND=noninteractive $run apt-get install -y -qq --no-install-recommends $ros1_packages >/dev/null
fi

# Network namespaces with a cable that can be pulled.
if ! command -v ip >/dev/null 2>&1; then
    if [ "$(id -u)" -eq 0 ]; then run=; else run=sudo; fi
    $run apt-get update -qq
    DEBIAN_FRONTEND=noninteractive $run apt-get install -y -qq --no-install-recommends iproute2 >/dev/null
fi

echo "peers are ready: .venv, and rosbag and rospy of /usr/bin/python3"
