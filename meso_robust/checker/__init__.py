"""An independent checker of certificates: it trusts nothing that it can compute itself.

It needs a certificate and its task. It shares no formula with the planner and its search: the
physics is written a second time, from the balance of the film's drag with the contacts' wrenches, in
ball arithmetic (Arb) on the exact rational numbers that the task's decimals spell; the barriers of a
rotation, thousands of boxes at once, in intervals of doubles that are rounded outward (``rows.py``).

What is proved
--------------
Of every move, from every pose of the box before it and for every error within its bounds:

1. *Start*: no tip touches the part (each stands off the line of the edge that faces it).
2. *Path*: the only motion (or every one, during a rotation) is enclosed. A tilt and a straightening
   stick: the force of sticking lies strictly inside Coulomb's cone at each angle that is passed, the
   tip presses, and the normal speed grows with the normal force however the contact slips, so there
   is no other motion (``contact.py``). Straightening ends with both tips (``straighten.py``). A
   rotation begins with one tip that sticks or slips (``approach.py``), cannot jam, cannot leave a tip
   (``rotate.py``), and slides between barriers (``slide.py``).
3. *Contacts* lie between the ends of their edges, and the idle tip is off the edge's line or beyond
   its end at each instant: no other point of the part can be touched.
4. *Arrival*: the probe's travel reaches what the move is for (touch, alignment, rest on both tips).
5. *Walls*, if the task has a slot: the part at every pose of the move, and every way of a tip, is
   beside each wall (``walls.py``).
6. *End*: all poses lie in the stated box; the tips back off without meeting the part.

The box after a move is the box before the next one (told exactly), the first holds every start of the
task, the last lies in the goal: by induction over the moves the policy ends in the goal.

What else is verified: each listed inequality over its stated box with its stated bound, every number
for reading, every sentence, and the margin's factor (the chain again with scaled uncertainties and no
help from the certificate). What cannot be verified is named in the answer.

The witness of a REFUTED certificate is followed by the same proofs, each range put to the run's number
(``replay.py``): a run that is proved to end in the goal is untrue, one that is proved to fail is
confirmed, and one that cannot be followed is said to be undecided. That a part jams between two tips is
proved by excluding every mode of contact in a stretch of the travel (``jam.py``).
"""
