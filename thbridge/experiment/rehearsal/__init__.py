"""Rehearsals: simulated people go through a whole experiment. Many rehearsals show how many people the experiment
needs."""
