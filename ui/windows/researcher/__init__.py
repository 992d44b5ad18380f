"""Window of the researcher: shows a session or a recording, with the truth next to what the robots believe."""
