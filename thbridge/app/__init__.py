"""Composition root, which builds all parts of a session from a study, and runs the session as a program."""
