"""Parts of the participant's view model, one concern a module."""
