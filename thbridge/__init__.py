"""The bridge and the game: everything that leaves a robot, and what people do with it."""
