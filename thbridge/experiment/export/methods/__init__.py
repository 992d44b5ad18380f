"""Text for the Method section of a paper, with the headings of APA's reporting standards."""
