"""ROS 1 graph over TCP: the sockets of `thbridge.rosgraph.wire`."""
