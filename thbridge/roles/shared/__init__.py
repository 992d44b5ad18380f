"""Common messages, rules and interfaces of the game's programs."""
