"""Real robots: their state from the messages that they publish, and the messages to them.

There are no sockets and no clocks here: messages come in with their time of arrival; values and messages come out.
"""
