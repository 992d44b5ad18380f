"""Session: roles that exchange messages through one router, common ticks, inputs from outside, and recording."""
