"""Telemetry: messages that a vehicle sends automatically, and their rates."""
