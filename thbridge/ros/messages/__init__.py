"""ROS 1 messages: types and definitions, records, and the conversion of values to bytes and back."""
