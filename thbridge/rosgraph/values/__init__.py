"""Names of the ROS graph."""
