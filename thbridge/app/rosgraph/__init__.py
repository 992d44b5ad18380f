"""A session on a live ROS graph: says there what a bag would hold, and takes what ROS clients ask."""
