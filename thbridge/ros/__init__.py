"""Team and game as ROS 1 messages: names, frames, message types and bytes. No installation of ROS is needed."""
