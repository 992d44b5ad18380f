"""The keeper: the one authority for a game's state. It judges requests, and sends orders, views and pictures."""
