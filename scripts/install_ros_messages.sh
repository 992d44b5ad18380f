#!/usr/bin/env bash
# Makes our message types known to an installed ROS 1, so that `rosbag check`, `rostopic echo` and rqt treat them like any other:
# the package under PREFIX/share, its Python classes, made by ROS's own generator, where Debian's Python looks for them.
set -euo pipefail
cd "$(dirname "$0")/.."

prefix=${1:-/usr/local}
generator=/usr/lib/genpy/genmsg_py.py
if [ ! -f $generator ]; then
    echo "ROS's message generator is not installed: sudo apt-get install python3-genpy" >&2
    exit 1
fi
.venv/bin/thbridge ros messages "$prefix/share"
messages=$prefix/share/thbridge_msgs/msg
version=$(/usr/bin/python3 -c 'import sys; print("python%d.%d" % sys.version_info[:2])')
classes=$prefix/lib/$version/dist-packages/thbridge_msgs
mkdir -p "$classes/msg"
touch "$classes/__init__.py"
/usr/bin/python3 $generator -p thbridge_msgs -Ithbridge_msgs:"$messages" -Istd_msgs:/usr/share/std_msgs/msg \
    -o "$classes/msg" "$messages"/*.msg
/usr/bin/python3 $generator --initpy -o "$classes/msg" -p thbridge_msgs
