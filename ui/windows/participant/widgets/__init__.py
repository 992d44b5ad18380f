"""Building blocks of the participant's window: buttons, panels, painting functions, and keyboard focus."""
