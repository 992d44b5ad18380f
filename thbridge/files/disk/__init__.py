"""Writing to disk: files are complete or do not exist, and names survive a power cut. Also temporary files."""
