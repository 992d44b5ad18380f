"""The software of one robot, from sensor messages to motor commands. It never sees the truth."""
