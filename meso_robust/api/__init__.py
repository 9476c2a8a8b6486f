"""What the verbs of the command line do, as calls: one file a verb.

``import meso_robust`` offers all of them. A call is silent unless it is given something that shows
progress, writes nothing unless given a place to write, and returns a plain value that prints its answer.

The command line reads the signatures for its options, also for ``--help``. So the files import what takes
long inside functions, and there after the files that were given are read: a bad one is refused at once.
"""
