"""What robots know of the game, suggest, and decide by themselves when nobody attends to them."""
