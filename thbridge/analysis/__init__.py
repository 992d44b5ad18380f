"""Analysis of recordings, ours and foreign: check, report, export, plot, convert, cut, compare."""
