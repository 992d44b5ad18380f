"""The game as values: rooms, treasures, costs, events, the state after these events, and the rules."""
