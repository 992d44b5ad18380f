"""View models of all windows: what they show and what people may do in them, as values and without Qt."""
