"""MAVLink 2 without its sockets: every robot as a ground rover, and the links to whoever watches and commands it.

Bytes become frames (`framer`), frames become messages (`dialect`), the `hub` brings each to the vehicles it is meant
for, a `vehicle` answers and asks its robot's `helm` for what it was told to do.

A vehicle is made of parts that hear and speak for themselves: `commands` (and the `repertoire` of what they do),
`controls` (sticks and setpoints), `missions`, the `parameter_protocol` and `courtesies`. They share its `conduct`
(modes, and what is done when a station is lost), the `command_of` its robot, the `streams` of its `telemetry`, and its
`texts`. On the other side of a link, a `ground_station` as small as the command line needs one makes a `trip`; vehicles
and it share no more than MAVLink and some `conventions`.
"""
