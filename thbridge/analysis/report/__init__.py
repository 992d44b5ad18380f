"""Report on a recording, ours or of other robots: paths, errors, deviations, events, dialogues."""
