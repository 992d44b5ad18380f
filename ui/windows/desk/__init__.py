"""Researcher's window for a study with people."""
