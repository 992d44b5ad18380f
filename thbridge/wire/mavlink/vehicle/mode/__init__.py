"""Modes: which one a robot is in and what it does in it, who commands it, driving by hand, home."""
