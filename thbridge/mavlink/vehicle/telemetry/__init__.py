"""Telemetry: the messages that a vehicle sends by itself, and their streams and rates."""
