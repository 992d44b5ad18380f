"""Layered costmaps: what it costs a robot to be somewhere."""
