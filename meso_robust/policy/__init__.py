"""Feedback policies: certified moves from every pose of a region, not from one start alone."""
