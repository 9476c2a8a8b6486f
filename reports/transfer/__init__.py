"""Which effects a promise survives: see README.md."""
