"""MAVLink 2 without its sockets: every robot as a ground rover, and the links to whoever watches and commands it.

Bytes become `frames`, frames become messages (`dialect`), the `hub` brings each to the vehicles it is meant for, a
`vehicle` answers and asks its robot's `helm` for what it was told to do. A `station` is the other end of a link.
"""
