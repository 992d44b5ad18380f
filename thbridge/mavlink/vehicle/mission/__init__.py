"""Missions: upload and download, meaning of the items, and execution."""
