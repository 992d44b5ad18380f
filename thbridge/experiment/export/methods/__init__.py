"""The text of a paper's Method section, under the headings of APA's reporting standards."""
