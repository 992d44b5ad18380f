"""Trials of plug-ins, which run a plug-in in many situations, and collect its faults."""
