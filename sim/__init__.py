"""One team of robots in one world, pure and deterministic: no ROS, wires, files, clocks or people in here."""
