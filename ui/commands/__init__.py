"""Commands of `thbridge`. Most imports are inside the commands' functions, so that the program starts fast."""
