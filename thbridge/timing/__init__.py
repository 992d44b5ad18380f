"""Wall clocks and loops: ticks kept to the clock until somebody stops the program."""
