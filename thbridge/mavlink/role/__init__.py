"""Robots as MAVLink vehicles in the game. Ground stations request moves of the game, or goals outside the game."""
