"""ROS 1 bags: reading, repair, and writing that loses little when programs are killed or disks are full."""
