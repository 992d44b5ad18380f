"""Arguments, their attacks on each other, and the sets that stand; pure, and independent of the game."""
