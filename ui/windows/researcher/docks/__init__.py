"""The docks around the researcher's map: team, lists, plots, timeline, wizard, what is displayed."""
