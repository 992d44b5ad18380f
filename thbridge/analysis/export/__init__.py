"""Recordings as tables: a topic's messages decoded column by column, by the definitions that the bag itself carries."""
