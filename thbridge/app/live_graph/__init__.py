"""Session on a live ROS graph, which publishes the messages of a bag, and accepts requests of ROS clients."""
