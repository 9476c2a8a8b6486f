"""What physics was left out: locate a mismatch, name it, model it, show that the fit improves."""
