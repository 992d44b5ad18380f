"""MAVLink as bytes: messages, frames, links, and the numbers of modes and coordinates in them."""
