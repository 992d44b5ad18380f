"""Everything that participants are shown before, during and after a game; nothing before they agree to take part."""
