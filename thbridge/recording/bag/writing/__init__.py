"""Writing of recordings: files of chunks, threads that write them, and streams for several readers."""
