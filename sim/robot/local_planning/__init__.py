"""Local planning: the command that follows a plan best among those that are safe."""
