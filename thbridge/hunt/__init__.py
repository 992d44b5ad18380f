"""The game as values: rooms, treasures, costs, events, the state folded from them, and the rules."""
