"""Participants of a game with several seats: their texts to each other, and their votes on decisions."""
