"""A session on a live ROS graph: publishes what a bag holds, and takes requests of ROS clients."""
