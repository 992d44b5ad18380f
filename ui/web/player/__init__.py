"""Player of a recording: one HTML file that opens from disk and plays every game of the recording."""
