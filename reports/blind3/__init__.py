"""The third blind trial of `diagnose`: laws in forms that its catalogue does not have."""
