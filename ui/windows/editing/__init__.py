"""Parts of windows that edit files."""
