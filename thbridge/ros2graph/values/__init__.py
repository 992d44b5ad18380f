"""The ROS 2 graph as values: nodes, endpoints, and what a carrier does."""
