"""Pop-ups over the participant's map: dialogues, treasures, confirmations, and the page after the game."""
