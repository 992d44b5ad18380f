"""Single functions of a robot for any maps and recordings: localize, plan, drive, scan, measure."""
