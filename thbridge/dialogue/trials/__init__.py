"""Trials of labs' programs that choose the moves of robots that argue, or word them."""
