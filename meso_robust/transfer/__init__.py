"""What a fitted model means for a promise: a plan is proved under premises, and effects break some.

A certificate holds as far as its premises do. A model that was fitted to recordings says how far
they do: its parameters become the task's ranges, and each effect of an extended model either is
absorbed (bounded over its whole interval and added to the task's errors) or breaks a named premise.
What is proved afterwards is proved for the laboratory that the model describes, and for no other.
"""
