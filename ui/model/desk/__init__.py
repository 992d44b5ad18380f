"""The researcher's desk beside a study with people: where everybody is, and what is asked of the host."""
