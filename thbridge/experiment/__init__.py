"""Studies with people: their design, participants, orders of conditions and answers, and the log of all events."""
