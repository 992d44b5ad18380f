"""Single parts of a robot run on any maps and recordings: localize, plan, drive, scan, measure."""
