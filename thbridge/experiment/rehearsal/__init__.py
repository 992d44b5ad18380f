"""Rehearsals: simulated people go through a whole experiment, and many rehearsals tell how many people it needs."""
