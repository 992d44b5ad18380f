"""The team and the game as ROS 1 says them: names, frames, message types and their bytes; no ROS is needed for it."""
