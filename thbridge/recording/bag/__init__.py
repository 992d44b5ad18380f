"""ROS 1 bags: written safe from kills and full disks, read whole or by index, repaired."""
