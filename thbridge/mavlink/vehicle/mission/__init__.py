"""Missions: upload, download, meaning of the items, execution."""
