"""Minimal ground station for the command line, the other end of a link."""
