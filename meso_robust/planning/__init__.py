"""Composing certified primitives into a plan."""
