"""move_base: from a goal to commands."""
