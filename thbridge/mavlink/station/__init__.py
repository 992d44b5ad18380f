"""Ground station, the other end of a link, as small as the command line needs it."""
