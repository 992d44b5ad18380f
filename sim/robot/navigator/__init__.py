"""move_base: from a goal to velocity commands."""
