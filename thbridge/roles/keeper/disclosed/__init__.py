"""All data for participants before, during and after a game. Before their consent, participants see no game data."""
