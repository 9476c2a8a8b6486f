"""Certificates: certifying a chain of moves, the margin, and the document."""
