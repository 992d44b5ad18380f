"""Values that vehicles, stations and roles share: options, conventions, and the interface of a vehicle to its robot."""
