"""What the participant's window is made of: buttons, panels, painted shapes, focus."""
