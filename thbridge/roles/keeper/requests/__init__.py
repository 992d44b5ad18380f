"""Requests to the keeper: by participants, by lines of 2016, by ground stations, by wizards."""
