"""N robots in one world, and the one order of doing things."""
