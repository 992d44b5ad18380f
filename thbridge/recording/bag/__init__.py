"""ROS 1 bags: written so that kills and full disks lose little, read whole or by index, repaired."""
