"""SimR: the robots' program. It drives a team by the keeper's orders, and sends pose telemetry."""
