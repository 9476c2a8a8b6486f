"""The properties; each idea has its own file, and each property one line in the registry."""
