"""Symbolic-analytic verification of pushing plans for mesoscale assembly."""

__version__ = "0.1.0"
