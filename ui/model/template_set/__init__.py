"""Editor's view of a template set."""
