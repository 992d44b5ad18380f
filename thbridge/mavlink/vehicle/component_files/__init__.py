"""Files with descriptions of a vehicle's parameters. Ground stations read them by MAVLink FTP."""
