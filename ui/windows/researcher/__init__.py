"""Researcher's window, which shows a session or a recording: the true state next to the robots' beliefs."""
