"""Trials of programs of labs, which choose or word what robots that argue say."""
