"""Global planning: the path to a goal, and the order in which robots pass places that their paths share."""
