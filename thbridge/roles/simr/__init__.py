"""SimR: the robots' program. It carries out the keeper's orders with a team of robots, and sends pose telemetry."""
