"""Study file as a form: fields from the schema, changes of the file's text, and the faults of each field."""
