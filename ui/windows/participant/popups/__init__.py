"""Pop-ups over the participant's map, for dialogues with robots and for treasures to name."""
