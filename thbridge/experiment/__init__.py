"""Studies with people: their design, who takes part, in which order, what they answer, and the log of all of it."""
