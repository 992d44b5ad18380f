"""What a recording tells about a session, and the page that shows it; ours and other robots' recordings."""
