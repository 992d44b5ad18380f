"""Pop-ups over the participant's map: a dialogue with a robot, a treasure to name."""
