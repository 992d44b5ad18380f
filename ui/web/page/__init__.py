"""Contents of a browser's page as values: what the page shows, differences between two pages, and messages about it."""
