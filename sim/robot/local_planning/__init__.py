"""Local planning: choice of the safe command that follows a plan best."""
