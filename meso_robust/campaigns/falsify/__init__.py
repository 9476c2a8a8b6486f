"""The kind *falsify*: adversarial search for a run that breaks what a certificate claims."""
