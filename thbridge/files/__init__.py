"""Files that people write and programs read: maps, templates, tables, keys; every fault is reported with a remedy."""
