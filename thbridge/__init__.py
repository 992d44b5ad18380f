"""The bridge and the game: messages of robots to other programs, and the treasure hunt with people."""
