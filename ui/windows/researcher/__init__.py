"""The researcher's window: a session or a recording, with the truth beside what the robots believe."""
