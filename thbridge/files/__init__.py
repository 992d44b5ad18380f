"""Files that people write and programs read: maps, templates, tables, keys; each fault told with its remedy."""
