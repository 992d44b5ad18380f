"""Trials of plug-ins: plug-ins run in situations of all kinds, and their faults are collected."""
