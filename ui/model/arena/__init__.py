"""An arena as it is drawn: its rooms and start poses, and the floor that they need."""
