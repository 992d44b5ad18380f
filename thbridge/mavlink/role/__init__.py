"""Robots as MAVLink vehicles in the game: ground stations request moves of the game, or goals outside it."""
