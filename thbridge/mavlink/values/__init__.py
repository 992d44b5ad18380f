"""Values that vehicles, stations and pilots share: options, conventions, and a vehicle's interface to its robot."""
