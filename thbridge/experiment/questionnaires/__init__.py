"""Questionnaires as data: forms in YAML, answers to items, scores by the declared key, and their reliability."""
