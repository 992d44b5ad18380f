"""Gateway: the server for browsers, the people who visit it, and what each of them goes through."""
