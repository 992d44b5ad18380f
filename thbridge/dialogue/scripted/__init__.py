"""Scripted questions of 2016: templates, the possible turns, and their engine."""
