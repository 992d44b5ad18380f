"""The programs of the game as pure cores, and their vocabulary: lines in, lines out, one step a tick."""
