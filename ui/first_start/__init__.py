"""First start: compile the simulator before the hunt, on several cores, with a progress bar."""
