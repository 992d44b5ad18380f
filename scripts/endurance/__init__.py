"""The parts of `long_run.py`: companions of a session, samples of what programs hold, and whether that grows."""
