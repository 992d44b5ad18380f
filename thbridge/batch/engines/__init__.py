"""Engines, which run the tasks of a batch on one or many machines."""
