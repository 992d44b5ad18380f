"""Replay of recordings: a new session gets the recorded inputs, and must send the recorded messages."""
