"""Everything that participants see before, during and after a game. They see nothing before they agree to take part."""
