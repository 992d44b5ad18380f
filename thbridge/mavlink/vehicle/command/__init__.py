"""Command protocol of MAVLink: decoding, authorization, execution and acknowledgement of commands."""
