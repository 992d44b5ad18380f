"""Arena that a person draws: rooms, start poses, and the free floor of the map."""
