"""The first start, which compiles the simulator: ahead of hunts, on several cores, with a bar and seconds."""
