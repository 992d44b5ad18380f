"""SimR, the robots' program: drives a team as the keeper orders, and sends pose telemetry."""
