"""Parameters of a vehicle, and the protocol by which they are read and set."""
