"""Dialogue games between two agents, independent of the hunt: locutions and tables as data, legality, control."""
