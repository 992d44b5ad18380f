"""Robots' knowledge of the game, suggestions, and decisions of their own when nobody attends to them."""
