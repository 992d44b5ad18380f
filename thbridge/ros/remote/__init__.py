"""Robots that are not ours to simulate: what is known of them from their messages, and what is said to them.

Without sockets and clocks: messages go in with the time of their arrival, values and messages come out.
"""

from thbridge.ros.remote.names import RemoteNames
from thbridge.ros.remote.robot import RemoteRobot

__all__ = ["RemoteNames", "RemoteRobot"]
