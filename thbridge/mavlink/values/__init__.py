"""Values that vehicles, stations and roles share: options, conventions, and what a robot is to its vehicle."""
