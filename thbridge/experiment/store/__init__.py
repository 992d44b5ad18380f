"""The store of an experiment: a log of all that happened, which notices whatever was changed or is missing in it."""
