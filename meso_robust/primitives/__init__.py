"""Certified motion primitives: all poses before a move to all poses after it."""
