"""Sockets of ROS 2 graphs, and nodes on them."""
