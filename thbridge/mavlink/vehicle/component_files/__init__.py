"""Files that a vehicle serves by MAVLink FTP: descriptions of its parameters for ground stations."""
