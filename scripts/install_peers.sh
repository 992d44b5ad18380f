#!/usr/bin/env bash
# Installs the programs of others that tests/peers plays against: the real ROS 1 tools, and Java for the clients of 2016.
# Tests whose program is missing are skipped and say so; nothing else depends on them.
set -uo pipefail

packages="python3-rosbag python3-rostopic python3-rosnode ros-core default-jdk-headless"

missing=""
for package in $packages; do
    if [ "$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null)" != installed ]; then
        missing="$missing $package"
    fi
done
if [ -z "$missing" ]; then
    exit 0
fi
if [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null; then
    echo "Installing for tests/peers:$missing"
    apt-get update -q &&
        DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends $missing >/dev/null && exit 0
    echo "They could not all be installed; the tests that need them will be skipped." >&2
else
    echo "The tests against the real ROS tools and Java will be skipped. To run them: sudo apt-get install$missing" >&2
fi
