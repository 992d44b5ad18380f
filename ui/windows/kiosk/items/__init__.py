"""Items of forms: what is asked, and a field for each kind of answer."""
