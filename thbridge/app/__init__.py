"""The composition root: builds every part of a session from one study, and runs it as a program."""
