"""View model of the desk, the researcher's window during a study with people."""
