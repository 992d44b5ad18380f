"""Parts of a robot run by themselves, on maps and recordings that need not be ours: localise, plan, drive, scan."""
