"""Items of forms: a question, and a field for each kind of answer."""
