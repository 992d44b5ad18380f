"""Checks of the computer that thbridge is to run on."""
