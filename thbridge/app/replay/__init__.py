"""Replay of recordings: a fresh session gets the recorded inputs, and must send the recorded messages."""
