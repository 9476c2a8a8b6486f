"""Columns of the CSV files and keys of the JSON documents that no model describes, told by hand.

``test_columns.py`` holds them against files that the package reads and writes.
"""

from __future__ import annotations

from dataclasses import dataclass

PROBE = "<probe>"
"""Stands for the name of each probe."""


@dataclass(frozen=True, slots=True)
class Column:
    """One column, or one key."""

    name: str
    meaning: str
    optional: bool = False


@dataclass(frozen=True, slots=True)
class Table:
    """A file by its columns.

    Attributes
    ----------
    title, about
        Heading of its section, and what the file is.
    columns
        In the order of the file.
    what
        They are.
    """

    title: str
    about: str
    columns: tuple[Column, ...]
    what: str = "column"

    def header(self, probes: tuple[str, ...], optional: bool = True) -> list[str]:
        """Names of the columns for some probes, all columns of a probe together.

        Parameters
        ----------
        probes
            Their names.
        optional
            Whether columns that may be left out are among them.
        """
        asked = [one.name for one in self.columns if optional or not one.optional]
        found = [name for name in asked if PROBE not in name]
        of_probe = [name for name in asked if PROBE in name]
        return found + [name.replace(PROBE, probe) for probe in probes for name in of_probe]


_TIME = Column("time_s", "instant of the frame, s; strictly increasing")
_TIPS = (
    Column("<probe>_x_um", "x of the tip's centre, µm, world frame"),
    Column("<probe>_y_um", "y of the tip's centre, µm, world frame"),
)

RECORDING = Table(
    "Columns of a recording (CSV)",
    'One row a frame; rows may be missing, an empty cell is "not seen", angles may wrap. Columns may '
    "stand in any order; others are refused.",
    (
        _TIME,
        Column("part_x_um", "x of the part's reference point, µm, world frame"),
        Column("part_y_um", "y of it, µm"),
        Column("part_theta_deg", "orientation of the part, deg, counter-clockwise"),
        Column("<probe>_x_um", "x of the tip's centre, µm, seen or commanded (`position_source`)"),
        Column("<probe>_y_um", "y of it, µm"),
        Column("<probe>_fx_un", "x of the force on the part, µN, world frame", optional=True),
        Column("<probe>_fy_un", "y of it, µN; with x or not at all", optional=True),
    ),
)
COMMANDS = Table(
    "The controller's log (CSV), read by `track --commands`",
    "One file a video, of the video's name with the ending `.csv`; written by your controller. Its rows have "
    "instants of their own, on the clock of the video; columns stand in this order, then those of the next probe. "
    'An empty cell is "not commanded".',
    (Column("time_s", "instant of the command, s; strictly increasing"), *_TIPS),
)
COVARIANCE = Table(
    "`…_covariance.csv`, written by `track` beside each recording",
    "One row a frame, all frames of the video; empty where nothing was seen.",
    (
        Column("time_s", "instant of the frame, s"),
        Column("state", "of the part: found, occluded, leaving, lost, ambiguous or repeated"),
        Column("part_xx_um2", "variance of the part's x, µm²"),
        Column("part_xy_um2", "covariance of x and y, µm²"),
        Column("part_xt_um_deg", "covariance of x and θ, µm deg"),
        Column("part_yy_um2", "variance of y, µm²"),
        Column("part_yt_um_deg", "covariance of y and θ, µm deg"),
        Column("part_tt_deg2", "variance of θ, deg²"),
        Column("<probe>_x_um", "x of the tip's centre as seen, µm, world frame"),
        Column("<probe>_y_um", "y of it, µm"),
        Column("<probe>_xx_um2", "variance of that x, µm²"),
        Column("<probe>_xy_um2", "covariance of that x and y, µm²"),
        Column("<probe>_yy_um2", "variance of that y, µm²"),
    ),
)
TRAJECTORIES = Table(
    "`trajectories.csv`, written by `simulate`",
    "One row a recorded instant; a cell is empty where a probe has no part in the move, and a run that ended early "
    "has the rows up to its end.",
    (
        Column("run", "nominal, worst, witness, or `sample K` from 0"),
        Column("move", "number of the move, from 1"),
        Column("part_of_move", "share of the travel that is done, 0 to 1"),
        Column("part_x_um", "x of the part's reference point, µm, world frame"),
        Column("part_y_um", "y of it, µm"),
        Column("part_theta_deg", "orientation of the part, deg"),
        *_TIPS,
    ),
)
CHECK = Table(
    "The answer of `check --json`",
    "Printed, not written to a file.",
    (
        Column("schema", "`meso-robust/check/1`"),
        Column(
            "verdict",
            "VERIFIED or MARGIN UNDECIDED (all but the margin); REJECTED; WITNESS CONFIRMED or WITNESS UNDECIDED (the certificate is REFUTED); "
            "NOTHING CLAIMED (it is UNKNOWN)",
        ),
        Column("claims", "what is verified, in the checker's own words"),
        Column("premises", "what the proof takes for granted: a sentence for each id"),
        Column(
            "rejected",
            "the first thing that is not so: `id` with its data `about` and the key `at`, the same in words "
            "as `claim`, `stated`, `found`; else null",
        ),
        Column("not_checked", "what the checker takes no position on, a sentence each"),
    ),
    "key",
)
DRIVE = Table(
    "Lines of `drive`",
    "Each line in is a sensed pose and gets one line out; it ends at the end of the input. A line in is a JSON object "
    "of `x_um`, `y_um` and `theta_deg`, the pose sensed after the last move was carried out (full turns do not "
    "matter). The very same line again, because the move was not carried out, gets the same move again. An answer "
    "has one of these forms, told apart by its key:",
    (
        Column(
            "probes", "a move as in `plan.json` (MoveDocument): carry it out, sense, send the pose"
        ),
        Column(
            "done",
            "true, with `within` (BoxDocument): the part lies in the goal, every true pose that is possible in "
            "this box. The next line is the first of the next part: nothing is remembered of this one",
        ),
        Column(
            "refused",
            "why nothing is proved from this pose, and which bound it misses by how much. It ends the part "
            "too: the next line is judged as a first one",
        ),
        Column(
            "error",
            "what is wrong with the line, which is no pose (a blank line too); nothing is changed by it",
        ),
    ),
    "key",
)
CAMPAIGN = Table(
    "`campaign.json`, written by `campaign`",
    "Result of each part; a nested key is written behind a dot.",
    (
        Column("schema", "`meso-robust/campaign-result/1`"),
        Column("name", "of the campaign"),
        Column(
            "verdict",
            "broken, incomplete (chunks are missing), open, held or measured: the first that holds",
        ),
        Column("hash", "SHA-256 of the campaign with everything that its files hold"),
        Column("seed", "from which everything random follows"),
        Column("confidence", "of all intervals"),
        Column(
            "totals_digest",
            "SHA-256 of all totals; the same however often the work was interrupted",
        ),
        Column("parts.name", "of the part"),
        Column("parts.kind", "monte-carlo, falsify, property, mutation or blind"),
        Column("parts.asked", "its keys as stated, with the defaults"),
        Column("parts.verdict", "of the part: broken, open, held or measured"),
        Column("parts.answer", "in words"),
        Column("parts.unit", "what `runs` counts"),
        Column("parts.runs", "how many were made"),
        Column("parts.failed", "how many of them failed"),
        Column("parts.chunks", "`planned` and `done`"),
        Column("parts.work_s", "seconds that the chunks took together"),
        Column("parts.figures", "what the kind found, as the report shows it"),
        Column("parts.totals", "what the kind adds up, by its own names"),
        Column(
            "parts.failures", "`chunk`, `what`, `detail`, `folder` and `files` of those written out"
        ),
        Column(
            "troubles",
            "chunks that were tried again: `at`, `part`, `chunk`, `attempt`, `what`, `given_up`",
        ),
        Column(
            "sessions",
            "`began`, `ended`, `crew`, `machine`, `runs` and `seconds` of each start of the command",
        ),
        Column("made_with", "versions, and the digest of the package's code"),
    ),
    "key",
)


def table(one: Table) -> str:
    """A table of columns as Markdown."""
    rows = [
        f"| `{column.name}` | {column.meaning}{'; may be left out' if column.optional else ''} |"
        for column in one.columns
    ]
    head = [f"### {one.title}", "", one.about, "", f"| {one.what} | is |", "|---|---|"]
    return "\n".join([*head, *rows, "", ""])
