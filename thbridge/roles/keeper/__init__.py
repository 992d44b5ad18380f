"""The keeper of the game, what it grants and shows: the one authority for what is hidden, visited, spent, scored."""
