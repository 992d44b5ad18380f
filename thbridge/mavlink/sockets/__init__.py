"""MAVLink over UDP and TCP: links from a session to ground stations, and the socket of our own ground station."""
