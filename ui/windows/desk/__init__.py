"""The researcher's window beside a study with people."""
