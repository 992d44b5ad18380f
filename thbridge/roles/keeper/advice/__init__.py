"""Robots' knowledge of the game, their suggestions, and their own decisions if the participant ignores them."""
