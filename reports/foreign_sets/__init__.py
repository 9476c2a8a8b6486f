"""Recordings from another plant, in which several things are a little wrong, and what is said of them."""
