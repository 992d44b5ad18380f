"""The commands of `thbridge`, one function each; what they need is imported when they are called."""
