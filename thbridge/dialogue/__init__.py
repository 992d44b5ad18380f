"""Dialogues between robots and a person, without I/O: templates, turns, strategies."""
