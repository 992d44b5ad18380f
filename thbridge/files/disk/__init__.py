"""Bytes on their way to a disk: files that are whole or not there, names that outlive a power cut, temporary files."""
