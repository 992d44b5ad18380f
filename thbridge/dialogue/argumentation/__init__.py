"""Arguments that attack each other, and which of them stand: pure, and without a word about the game."""
