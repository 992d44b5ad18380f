"""Export of recordings as tables: messages decoded into columns, using the definitions in the bag."""
