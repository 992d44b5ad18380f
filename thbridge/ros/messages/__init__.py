"""ROS 1 messages: their types and definitions, their values, and values as bytes and back."""
