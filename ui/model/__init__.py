"""View models of all windows, as values and without Qt: the contents of windows, and the acts of people in them."""
