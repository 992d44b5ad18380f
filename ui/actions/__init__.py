"""The work of commands behind their options: each module is loaded when its command is called."""
