"""Messages read field by field, by the definitions in the bag."""
