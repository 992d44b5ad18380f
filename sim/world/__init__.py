"""The truth: physics, what sensors perceive of it and how they err, and the things that stand or walk in the way."""
