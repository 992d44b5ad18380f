"""ROS 1 bags: writing that loses little when programs are killed or disks are full, reading, and repair."""
