"""Recordings run again: a fresh session gets what came from outside, and must say what the recorded one said."""
