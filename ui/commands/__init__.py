"""Commands of `thbridge`, one function each; their imports run when a command is called."""
