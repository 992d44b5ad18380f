"""Writing, reading and repair of sessions' recordings: bags, journals, telemetry logs."""
