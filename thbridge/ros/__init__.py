"""The team and the game as ROS 1 messages: names, frames, message types and their bytes. No installed ROS is needed."""
