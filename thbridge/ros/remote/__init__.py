"""Real robots: their state from the messages that they publish, and the messages to them.

There are no sockets and no clocks here: messages go in with the time of their arrival, values and messages come out.
"""
