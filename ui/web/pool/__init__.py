"""Games in processes of their own: what a worker plays, its messages, and the pool that starts workers."""
