"""The study file: its sections with all settings, its text, and changes to its keys."""
