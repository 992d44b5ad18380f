"""Single parts of a robot run on any maps and recordings: localise, plan, drive, scan, measure."""
