"""Robots as MAVLink vehicles in the game: requests of ground stations become moves of the game, or goals beside it."""
