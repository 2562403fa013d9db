#!/bin/sh
# Real ROS 2 nodes for the tests that talk to them (crates/ros/tests/ros2): rclpy with Fast DDS, and Cyclone DDS without ROS.
#
#   tools/ros2.sh            # Jazzy, which ./test wants
#   tools/ros2.sh kilted     # another distribution; LAPWING_ROS2=kilted makes the tests use it
#
# Makes .venv-DISTRIBUTION beside this folder's parent: 300 MB, half a minute. Does only what is missing: a second run takes no time.
set -eu

cd "$(dirname "$0")/.."

for distribution in "${@:-jazzy}"; do
    venv=.venv-$distribution
    packages="ros-$distribution-rclpy ros-$distribution-common-interfaces ros-$distribution-rmw-fastrtps-cpp cyclonedds pytest"
    case $distribution in
        jazzy) ;;
        kilted) packages="$packages ros-kilted-rmw-implementation" ;;
        *)
            echo "no packages are known of \`$distribution\`: there are jazzy and kilted" >&2
            exit 2
            ;;
    esac
    if [ ! -x "$venv/bin/python" ]; then
        python3 -m venv "$venv"
    fi
    if ! "$venv/bin/python" -c 'import rclpy, nav_msgs.msg, std_srvs.srv, cyclonedds, pytest' 2>/dev/null; then
        # shellcheck disable=SC2086  # one word per package is meant
        "$venv/bin/pip" install --quiet $packages
    fi
    echo "ROS 2 $distribution is ready: $venv"
done
