"""Parts of the participant's view model, one per module."""
