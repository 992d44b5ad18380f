"""Separate functions of a robot for any map or recording: localize, plan, drive, scan, measure."""
