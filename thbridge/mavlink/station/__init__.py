"""Minimal ground station for commands of the command line."""
