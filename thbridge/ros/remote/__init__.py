"""Real robots: their states from their messages, and messages to them.

This package has no sockets and no clocks. Its inputs are messages with their times of arrival. Its outputs are values
and messages.
"""
