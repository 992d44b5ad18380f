"""The study file: all settings, in sections; its text, and changes to it."""
