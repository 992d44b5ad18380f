"""The ROS 1 graph over TCP: carries out what `thbridge.wire.rosgraph` decides."""
