"""The wire protocols of ROS 2 as functions of bytes: RTPS (DDS), and the keys of rmw_zenoh."""
