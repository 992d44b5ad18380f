"""Layered costmaps: costs of all places for a robot."""
