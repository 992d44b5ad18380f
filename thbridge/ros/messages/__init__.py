"""ROS 1 messages: types and definitions, records, conversion of values to bytes and back."""
