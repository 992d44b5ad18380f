"""A team of robots in one world, pure and deterministic: without ROS, networks, files, clocks or people."""
