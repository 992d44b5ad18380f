"""Messages read field by field, using the definitions in the bag."""
