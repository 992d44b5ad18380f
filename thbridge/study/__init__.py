"""The study around the game: simulated participants and reports."""
