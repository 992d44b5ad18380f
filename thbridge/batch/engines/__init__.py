"""Engines: they carry out the tasks of a sweep, on this machine or on many machines."""
