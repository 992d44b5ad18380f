"""Items of forms. Each item is a question with a field for its kind of answer."""
