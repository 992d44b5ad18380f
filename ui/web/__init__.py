"""Browser as a front end: pages as values, a gateway for browsers, workers that play games, and the page's files."""
