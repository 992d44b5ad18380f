"""MAVLink over UDP and TCP: the links of a session to ground stations, and a ground station's own socket."""
