"""The keeper: the only authority for a game's state. It decides on requests, and sends orders, views and pictures."""
