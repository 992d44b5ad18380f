"""Parts of `long_run.py`: clients of a session, samples of used resources, and tests for growth."""
