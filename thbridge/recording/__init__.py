"""All that makes, reads and mends the record of a session: bags, journals, telemetry logs."""
