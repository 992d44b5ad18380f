"""What pops up over the participant's map: a talk with a robot, a treasure to name."""
