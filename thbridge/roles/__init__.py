"""Programs of the game without sockets: messages in, messages out, one step a tick; and the notices between them."""
