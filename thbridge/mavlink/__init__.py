"""MAVLink 2 without its sockets: every robot as a ground rover, and the links to ground stations.

`frames` turns bytes into frames, and `dialect` turns frames into messages. The `hub` routes each message to the
vehicles that it is addressed to. A `vehicle` answers the message and commands its robot through the
`vehicle_interface`. A `station` is the other end of a link.
"""
