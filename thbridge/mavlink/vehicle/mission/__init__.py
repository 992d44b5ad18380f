"""Missions: upload, download, meaning of the items, and execution."""
