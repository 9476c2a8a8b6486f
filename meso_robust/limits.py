"""The most that may be asked for, by word or by call."""

MOST_SAMPLES = 1_000_000
"""Random runs in the simulator."""
MOST_WORKERS = 1024
"""Processes of a campaign."""
LONGEST_LATENCY_MS = 1000.0
"""Delay of a camera."""
