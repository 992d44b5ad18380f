"""What researchers make of recordings, ours and foreign: judge, report, export, plot, convert, cut, compare."""
