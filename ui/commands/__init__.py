"""The commands of `thbridge`, one function each."""
