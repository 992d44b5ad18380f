"""What pops up over the participant's map: a talk, a find, a question, the end of the game."""
