"""Report of a recording as an HTML page."""
