"""Command protocol of MAVLink: decoding, authorisation, execution and acknowledgement of commands."""
