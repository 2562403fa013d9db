#!/bin/sh
# Other people's recording tools, for the tests that compare ours with theirs (crates/record/tests/others.rs).
#
# Makes .venv beside this folder's parent with rosbags and mcap, and installs ROS 1's own rosbag from the distribution.
# Does only what is missing: a second run takes no time.
set -eu

cd "$(dirname "$0")/.."

python_packages='rosbags==0.11.* mcap mcap-ros2-support protobuf'
ros1_packages='ros-core python3-rosbag python3-genpy python3-std-msgs python3-geometry-msgs python3-nav-msgs python3-sensor-msgs'

if [ ! -x .venv/bin/python ]; then
    python3 -m venv .venv
fi
if ! .venv/bin/python -c 'import rosbags.rosbag2, rosbags.rosbag1, mcap.writer, mcap_ros2.writer, google.protobuf.message_factory' 2>/dev/null; then
    # shellcheck disable=SC2086  # one word per package is meant
    .venv/bin/pip install --quiet $python_packages
fi

if ! /usr/bin/python3 -c 'import rosbag, nav_msgs.msg, sensor_msgs.msg' 2>/dev/null; then
    if [ "$(id -u)" -eq 0 ]; then run=; else run=sudo; fi
    $run apt-get update -qq
    # shellcheck disable=SC2086
    DEBIAN_FRONTEND=noninteractive $run apt-get install -y -qq --no-install-recommends $ros1_packages >/dev/null
fi

echo "peers are ready: .venv and /usr/bin/python3 rosbag"
