"""Programs of the game without sockets: one step per tick takes messages and returns messages. Also their notices."""
