"""Requests to the keeper: from participants, in lines of 2016, from ground stations, from wizards."""
