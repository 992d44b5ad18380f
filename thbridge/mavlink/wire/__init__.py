"""MAVLink as bytes: messages, frames, links, and MAVLink's numbers for modes and coordinates."""
