"""MAVLink as bytes: messages, frames, links, and their numbers for modes and coordinates."""
