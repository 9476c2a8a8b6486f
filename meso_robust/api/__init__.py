"""What the verbs of the command line do, as calls: one file a verb.

``import meso_robust`` offers all of them. A call is silent unless it is given something that shows
progress, writes nothing unless given a folder, and returns a plain value that prints its answer.

The command line reads the signatures for its options, also for ``--help``. So slow imports go inside
functions, and there after the given files have been read: a bad file is refused at once.
"""
