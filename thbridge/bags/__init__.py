"""Work on recordings, ours and foreign ones: judge, export, plot, convert, cut, compare."""
