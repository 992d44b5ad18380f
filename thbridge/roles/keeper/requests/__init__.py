"""What is asked of the keeper: by participants, by lines of 2016, by ground stations, by wizards."""
