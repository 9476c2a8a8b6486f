"""Campaigns: many runs of a plan in the simulator."""
