"""Report of a recording, ours or of other robots: its data, and the HTML page that shows them."""
