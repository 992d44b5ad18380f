"""A robot as a rover: `vehicle` puts it together of parts, each of which hears messages and speaks for itself.

`commands` with `repertoire` and `message_requests`, `controls`, `older_ways`, `missions`, `home`, `parameter_protocol`,
`file_transfer`, `courtesies` and `texts` are such parts; `conduct` is what all of them lead to: mode, who commands
(`command_of`), and what the robot does about it.
"""
