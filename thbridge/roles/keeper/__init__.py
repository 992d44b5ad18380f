"""The keeper: the only program that changes a game's state. It decides on requests, and sends orders, views and
pictures."""
