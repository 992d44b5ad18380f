"""Analysis of recordings from thbridge and other robots: check, report, export, plot, convert, cut, compare."""
