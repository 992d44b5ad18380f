"""Telemetry: the messages that a vehicle sends automatically, with their streams and rates."""
