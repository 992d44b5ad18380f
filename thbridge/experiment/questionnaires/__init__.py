"""Questionnaires: forms in YAML, answers to their items, and scores with their reliability."""
