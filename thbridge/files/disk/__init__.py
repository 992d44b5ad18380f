"""Writing to disk: files that are complete or do not exist, names that survive a power cut, temporary files."""
