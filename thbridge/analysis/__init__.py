"""Analysis of recordings of thbridge and of other robots: check, report, export, plot, convert, cut, compare."""
