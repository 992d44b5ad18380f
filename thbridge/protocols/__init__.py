"""Protocol cores without sockets, clocks or threads: bytes and times in, values out."""
