"""Export of recordings as tables: messages decoded into columns, by the definitions in the bag."""
