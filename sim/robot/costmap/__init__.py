"""Layered costmaps: the cost for a robot of being in a place."""
