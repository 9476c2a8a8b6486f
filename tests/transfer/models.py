"""Fitted models as they stand in files, with what a test wants in them."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from meso_robust.identification.document import ModelDocument, parse_model
from meso_robust.toml_files import toml_of
from meso_robust.transfer.inflation import Budget

Ends = tuple[float, float]
PLAIN: Mapping[str, Ends] = {"rho_um2": (372_000.0, 381_000.0), "mu": (0.32, 0.34)}


def values(
    effects: Mapping[str, Ends] | None = None,
    *,
    base: Mapping[str, Ends] = PLAIN,
    held: Mapping[str, float] | None = None,
    open_: tuple[str, ...] = (),
    **more: Any,
) -> dict[str, Any]:
    """Values of a ``model.toml``: ``effects`` has the interval of each ``effect.parameter``."""
    ranges = {**base, **(effects or {})}
    names = dict.fromkeys(key.partition(".")[0] for key in (*ranges, *(held or {})) if "." in key)
    best = {key: 0.5 * (low + high) for key, (low, high) in ranges.items()}
    return {
        "schema": "meso-robust/model/1",
        "model": "+".join(["viscous", *names]),
        "objective": "likelihood",
        "interval": "profile likelihood",
        "confidence": 0.9,
        "part": {"length_um": 1616.0, "width_um": 837.0},
        "parameters": {
            key: {
                "value": best[key],
                "low": low,
                "high": high,
                "open_low": key in open_,
                "open_high": key in open_,
            }
            for key, (low, high) in ranges.items()
        },
        "held": dict(held or {}),
        "not_identifiable": [],
        "minima": [
            {
                "cost": 1.0,
                "x_um": 0.3,
                "y_um": 0.3,
                "theta_deg": 0.02,
                "found": 1,
                "parameters": best,
            }
        ],
        "recording": [],
        "provenance": {
            "recordings_sha256": "0" * 64,
            "seed": 0,
            "starts": 1,
            "meso_robust": "0",
            "notes": [],
        },
        **more,
    }


def model(*args: Any, **rest: Any) -> ModelDocument:
    """The document of `values`."""
    return parse_model(values(*args, **rest), "a model")


def written(folder: Path, *args: Any, **rest: Any) -> Path:
    """The file of `values`."""
    path = folder / "model.toml"
    path.write_text(toml_of(model(*args, **rest)), encoding="utf-8")
    return path


def budget(**changes: Any) -> Budget:
    """What effects on the paper's part are bounded for, with changes."""
    plain: dict[str, Any] = {
        "radius_um": 2500.0, "seconds": 120.0, "ratio_um2": 380e3, "least_ratio_um2": 370e3,
        "slender": 1616 / 837, "rectangle": True, "reach_um": 910.0, "speed_um_s": 75.0, "press": 0.99,
        "turn_per_um": 1.5e-4, "capped": False,
    }  # fmt: skip
    return Budget(**{**plain, **changes})
