"""The messages of robots and game in ROS 2: types, hashes, CDR, names, quality of service, actions, parameters."""
