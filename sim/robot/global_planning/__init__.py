"""Global planning: paths to goals, and the order in which robots pass places that their paths share."""
