"""Report on a recording of thbridge or other robots: paths, errors, deviations, events, dialogues."""
