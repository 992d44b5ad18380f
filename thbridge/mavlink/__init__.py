"""MAVLink 2 without its sockets: every robot as a ground rover, and the links to ground stations.

Bytes become `frames`, frames become messages (`dialect`), the `hub` routes each to the vehicles it is meant for, a
`vehicle` answers it and commands its robot through the `vehicle_interface`. A `station` is the other end of a link.
"""
