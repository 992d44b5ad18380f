"""Modules of the participant's view model."""
