"""Arguments, their attacks on each other, and sets that can be accepted together; independent of the hunt."""
