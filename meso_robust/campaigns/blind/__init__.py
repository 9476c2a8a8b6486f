"""The benchmark of the diagnosis: recordings in which something is concealed.

A corpus is a folder with recording sets, each a folder of ``sets``, and apart from them a file that
tells what is concealed in each: ``labels.jsonl``, or ``sealed.jsonl`` if the labels were committed to
(``commitment.json``) before the first diagnosis. Whoever makes a corpus must not use the simulator
that the diagnosis fits: else nothing but its inverse is tested.

``judging`` and ``scoring`` are the rules; they know nothing of how the diagnosis works. The labels
are opened when answers are added up, never while one is sought.
"""
