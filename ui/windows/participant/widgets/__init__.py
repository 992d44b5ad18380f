"""Building blocks of the participant's window: buttons, panels, painted shapes, focus."""
