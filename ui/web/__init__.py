"""Browser as a front end: pages of a game and a study on the server, a gateway for browsers, and the files they load."""
