#!/usr/bin/env bash
# Installs the message types of our bags in an existing ROS 1, so that `rosbag check`, `rostopic echo` and rqt handle them
# like other types. The packages are thbridge_msgs and, if ROS has no mavros, mavros_msgs with the two messages that we
# record. The packages are installed in PREFIX/share. ROS's generator makes their Python classes, where Debian's Python finds
# them.
set -euo pipefail
cd "$(dirname "$0")/.."

prefix=${1:-/usr/local}
generator=/usr/lib/genpy/genmsg_py.py
if [ ! -f $generator ]; then
    echo "ROS's message generator is not installed: sudo apt-get install python3-genpy" >&2
    exit 1
fi
version=$(/usr/bin/python3 -c 'import sys; print("python%d.%d" % sys.version_info[:2])')
stamp=$prefix/lib/$version/dist-packages/thbridge_msgs/made_from
wanted=$(cat "scripts/$(basename "$0")" thbridge/ros/messages/types.py thbridge/ros/messages/definition_texts.py \
    thbridge/files/ros/package.py $generator | sha256sum)
if [ "$(cat "$stamp" 2>/dev/null)" = "$wanted" ]; then
    exit 0
fi
.venv/bin/thbridge ros messages "$prefix/share"
for package in thbridge_msgs mavros_msgs; do
    messages=$prefix/share/$package/msg
    [ -d "$messages" ] || continue
    classes=$prefix/lib/$version/dist-packages/$package
    mkdir -p "$classes/msg"
    touch "$classes/__init__.py"
    /usr/bin/python3 $generator -p $package -I$package:"$messages" -Istd_msgs:/usr/share/std_msgs/msg \
        -o "$classes/msg" "$messages"/*.msg
    /usr/bin/python3 $generator --initpy -o "$classes/msg" -p $package
done
echo "$wanted" >"$stamp"
