"""A session on a live ROS graph: publishes the messages of a bag, and accepts requests of ROS clients."""
