"""Functions of the stepper's kernel, each with an entry from Python of its own."""

from meso_robust.simulator import (
    advance as steps,
    arrange,
    guess,
    lemke as pivots,
    modes,
    nonnegative,
    rows,
    scene,
    support,
    tables,
)
from tests.entry import entry

advance = entry(steps.advance)
closes = entry(steps.closes)
is_ambiguous = entry(steps.is_ambiguous)
case_of = entry(arrange.case_of)
guess_forces = entry(guess.guess_forces)
goes_first = entry(pivots._goes_first)
lemke = entry(pivots.lemke)
new_walk = entry(modes.new_walk)
next_mode = entry(modes.next_mode)
nearest = entry(nonnegative.nearest)
assemble = entry(rows.assemble)
is_solution = entry(rows.is_solution)
move_by_forces = entry(rows.move_by_forces)
write_rows = entry(rows.write_rows)
find_contacts = entry(scene.find_contacts)
factorise = entry(support.factorise)
workspace = entry(tables.workspace)
