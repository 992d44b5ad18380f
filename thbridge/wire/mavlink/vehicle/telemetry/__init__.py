"""Telemetry: what a vehicle says of itself, in which streams, how often, to whom."""
