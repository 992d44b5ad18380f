"""Requests to the keeper from participants, lines of 2016, ground stations and wizards."""
