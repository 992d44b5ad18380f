"""SimR, the robots' program: drives a team by the keeper's orders, and sends pose telemetry."""
