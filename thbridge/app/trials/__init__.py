"""Trials of plug-ins: situations of all kinds, in which faults are collected."""
