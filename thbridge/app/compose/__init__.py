"""The composition root: builds every part of a session from one study. No other module looks up its parts."""
