"""Recordings of sessions, written, read and repaired: bags, journals, telemetry logs."""
