"""Real robots: their states are read from the messages that they publish, and messages are sent to them.

This package has no sockets and no clocks. Its inputs are messages with their times of arrival. Its outputs are values
and messages.
"""
