"""Engines: what carries out the tasks of a sweep, on this machine or on many."""
