"""Study file as a form: fields made from its schema, changes of its text, and faults at their fields."""
