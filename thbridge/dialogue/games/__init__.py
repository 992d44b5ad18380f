"""Dialogue games between two agents, without a word about the hunt: locutions and tables as data, legality, control."""
