"""Scripted questions of 2016: templates, the turns they leave, and their engine."""
