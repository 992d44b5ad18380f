"""Files that people write and programs read, such as maps, templates, tables and keys. Messages give a remedy."""
