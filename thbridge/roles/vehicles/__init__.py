"""Robots as MAVLink vehicles in the game: what ground stations ask becomes moves of the game, or goals beside it."""
