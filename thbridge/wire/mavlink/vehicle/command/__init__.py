"""Commands of MAVLink: how they come in, who may give which, what each does, how it is acknowledged."""
