"""The composition root: builds every part of a session from one study. Other modules get their parts as arguments."""
