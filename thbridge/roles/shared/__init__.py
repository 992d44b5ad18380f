"""Messages, rules and interfaces that the programs of the game share."""
