"""Composition root, which builds all parts of a session from a study. All other modules get parts as arguments."""
