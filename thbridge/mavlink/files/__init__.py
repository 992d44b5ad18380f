"""Files of MAVLink: keys, timestamps of signed links, and telemetry logs."""
