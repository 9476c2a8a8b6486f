"""Whether one delay and one scale by axis of a rig predict recordings of it that they were not fitted to."""
