"""The other end: a small ground station, and a trip that it sends a robot on."""
