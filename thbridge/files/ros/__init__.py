"""Files of ROS: parameters of a navigation stack, message definitions, packages."""
