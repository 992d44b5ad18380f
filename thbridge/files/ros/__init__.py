"""Files of an installed ROS or for it: parameters of a navigation stack, message definitions, packages."""
