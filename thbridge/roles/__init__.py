"""The programs of the game as pure cores: lines in, lines out, one step a tick."""
