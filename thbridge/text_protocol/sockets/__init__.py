"""Server and client of the 2016 text protocol over TCP."""
