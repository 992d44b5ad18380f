"""Local planning: the safe command that follows a plan best."""
