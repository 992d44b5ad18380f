"""The ROS 2 graph: nodes, topics, services and actions over DDS or zenoh."""
