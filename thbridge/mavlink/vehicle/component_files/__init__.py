"""Files that a vehicle serves by MAVLink FTP: what its parameters mean, for ground stations."""
