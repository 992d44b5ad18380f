"""Programs of the game, without their sockets.

Each step of a program receives messages and returns messages. This package also has the notices between the programs.
"""
