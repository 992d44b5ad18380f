"""MAVLink 2: every robot as a ground rover, and the links to ground stations.

`frames` converts bytes to frames, and `dialect` converts frames to messages. The `hub` routes each message to its
target vehicles. A `vehicle` answers the message and commands its robot through the `vehicle_interface`. `station` is a
ground station at the other end of a link.
"""
