"""ROS 1 messages: their types and definitions, our records, and the conversion of values to bytes and back."""
