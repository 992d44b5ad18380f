"""A study file as a form: fields made from its schema, changes to its text, faults at their fields."""
