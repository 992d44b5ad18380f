"""Robots' knowledge of the game, their suggestions, and their own decisions when the participant ignores them."""
