"""The kind of campaign *property*: laws that the package must obey, at any number of examples."""
