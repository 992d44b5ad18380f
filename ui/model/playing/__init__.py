"""What the participant's view model is made of, one concern a module."""
