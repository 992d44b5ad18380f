"""Researcher's window, which shows the true state and the robots' beliefs in a session or a recording."""
