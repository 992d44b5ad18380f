"""Questionnaires as data: forms in YAML, answers item by item, scores by the declared key, and their reliability."""
