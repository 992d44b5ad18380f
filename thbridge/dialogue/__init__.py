"""Dialogues between robots and a person, sans-IO: templates, turns, strategies."""
