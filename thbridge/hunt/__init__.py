"""The game as values: rooms, treasures, costs, events, the state that results from them, and the rules."""
