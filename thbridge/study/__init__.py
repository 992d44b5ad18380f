"""The study file: everything an admin can set, its sections, its text, and changes to it."""
