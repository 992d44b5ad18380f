"""Global planning: which way to a goal, and in which order with the other robots."""
