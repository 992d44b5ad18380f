"""Where the researcher's window gets what it shows: a session under way, or a recording."""
