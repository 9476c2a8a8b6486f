"""The paper's tables and figures made again, printed value beside ours: `reproduced`.

One file an item, and its line in `items.ITEMS`. What the paper leaves out is a stated input, and
where it matters the result is shown over its range.
"""
