"""Tables of an experiment's log, for pandas and R: people, steps, answers, scores, and every event."""
