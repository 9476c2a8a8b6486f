"""Made-up diagnoses, one of every verdict, with signs that HTML and formulas must not see."""

from __future__ import annotations

from typing import Any

import numpy as np

from meso_robust.diagnosis.document import DiagnosisDocument, Verdict
from meso_robust.diagnosis.evidence import Evidence

UM, DEG = 1e-6, np.pi / 180.0
SIGMA = np.array([1.2 * UM, 1.2 * UM, 0.08 * DEG])
FRAMES, LOST = 240, 7
"""Instants of a recording, and how many of them the camera lost."""
NAMES = ("a<b>&$x$_0.csv", *(f"push_{k:02d}.csv" for k in range(1, 12)))
HELD_OUT, EXTRAPOLATION = NAMES[8:], NAMES[10:]
HALF = np.array([808.0, 418.5]) * UM

VALUE = {"value": 376900.0, "low": 371000.0, "high": 383000.0, "unit": "µm²"}
DRY = {
    "name": "dry_friction",
    "probability": 0.97,
    "stage": "support",
    "equation": "f = −τ u/|u| on every part of the area",
    "parameters": {"ratio": {"value": 0.21, "low": 0.18, "high": 0.24}},
}
FORCE = {
    "name": "body_force",
    "probability": 0.52,
    "stage": "environment",
    "equation": "F = e_x b at the reference point, constant in the stage's frame",
    "parameters": {
        "x_um_s": {"value": -1.5, "low": -1.9, "high": -1.1},
        "y_um_s": {"value": 0.4, "low": 0.1, "high": 0.7},
    },
}


def evidence(verdict: Verdict, seed: int = 3) -> Evidence:
    """Twelve pushes that turn the part; the plain model is 12 µm and 0.6° off at the end of most."""
    rng = np.random.default_rng(seed)
    share = np.clip(np.linspace(-0.3, 1.15, FRAMES), 0.0, 1.0)[:, None]
    rows = len(NAMES)
    truth, tips = np.zeros((rows, FRAMES, 3)), np.zeros((rows, FRAMES, 1, 2))
    for row in range(rows):
        start = [*rng.uniform(-400 * UM, 400 * UM, 2), rng.uniform(-np.pi, np.pi)]
        ahead = np.array([np.cos(start[2]), np.sin(start[2])])
        truth[row] = start + share * [*(420 * UM * ahead), rng.uniform(-0.25, 0.25)]
        back = np.clip(share - 1.0 + 0.1, 0.0, None) * 60 * UM
        tips[row, :, 0] = truth[row, :, :2] - (HALF[0] + 12.5 * UM + back) * ahead
    seen = truth + SIGMA * rng.standard_normal(truth.shape)
    seen[:, rng.permutation(FRAMES)[:LOST]] = np.nan
    wrong = rng.standard_normal((rows, 1, 3)) * [9 * UM, 9 * UM, 0.6 * DEG]
    off = 0.0 if verdict == "consistent" else share * wrong
    none = verdict in ("consistent", "unknown")
    return Evidence(
        files=NAMES,
        outline=np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * HALF,
        tip_radius=12.5 * UM,
        instants=np.tile(np.arange(FRAMES) / 30.0, (rows, 1)),
        seen=seen,
        tips=tips,
        baseline=truth + off,
        extended=None if none else truth + 0.05 * off,
        sigma=SIGMA,
        held_out=HELD_OUT,
        extrapolation=EXTRAPOLATION,
        null_statistics=np.sort(rng.gumbel(3.0, 0.5, 200)),
        statistic=3.4 if verdict == "consistent" else 41.0,
    )


def span(name: str, start: float, end: float, channel: str, component: str) -> dict[str, Any]:
    return {
        "recording": name,
        "start_s": start,
        "end_s": end,
        "phase": "one_point",
        "channel": channel,
        "component": component,
        "sigma": 12.3,
        "grows_with": "<speed>" if component == "theta" else "",
    }


SPANS = (
    span(NAMES[0], 1.7, 4.2, "support", "theta"),
    span(NAMES[0], 3.1, 4.2, "support", "x"),
    span(NAMES[3], 1.9, 7.0, "contact", "y"),
    span(NAMES[5], 2.5, 6.1, "environment", "theta"),
    span(NAMES[7], 2.5, 3.1, "observation", "x"),
)


def document(verdict: Verdict, **changes: Any) -> DiagnosisDocument:
    """A document of a verdict; `changes` replaces sections."""
    found = verdict != "consistent"
    effects = {"named": (DRY,), "partial": (DRY,), "ambiguous": (FORCE,)}.get(verdict, ())
    extended = bool(effects)
    before = 4.1 if found else 1.02
    after = 1.05 if extended else before
    given: dict[str, Any] = {
        "schema": "meso-robust/diagnosis/2",
        "verdict": verdict,
        **graded(verdict),
        "why": f"The reason of {verdict} <in one sentence>.",
        "baseline": {
            "model": "viscous",
            "parameters": {"rho_um2": VALUE, "mu": {"value": 0.331, "low": 0.32, "high": 0.343}},
        },
        "noise": {
            "position_sigma_um": 1.2,
            "orientation_sigma_deg": 0.08,
            "correlation": 0.21,
            "source": "set.toml",
        },
        "training": NAMES[:8],
        "mismatch": {
            "detected": found,
            "p_value": 0.004975 if found else 0.43,
            "threshold": 0.02,
            "nulls": 200,
            "tests": (
                {"name": f"{NAMES[0]}: θ", "kind": "recording", "sigma": 41.0},
                {"name": "dry_friction", "kind": "signature", "sigma": 38.0},
            ),
            "where": SPANS if found else (),
        },
        "effects": effects,
        "ambiguous_with": (("film_flow",), ("camera_drift", "backlash"))
        if verdict == "ambiguous"
        else (),
        "not_identifiable": ("film_viscosity", "drag_drift"),
        "not_identifiable_why": (
            {
                "effect": "drag_drift",
                "detectability": 0.0,
                "alike": ("shear_thinning",),
                "push": "none: motion alone never shows it; measure a force",
            },
        ),
        "candidates": (
            candidate(("dry_friction",), 212.0, 0.97, True, ""),
            candidate(("stribeck_friction",), 160.0, 0.02, False, "recording 3 stays 6 σ off"),
            candidate((), 0.0, 0.0, False, "a mismatch is detected"),
        )
        if found
        else (),
        "channels": (
            {"channel": "support", "share": 0.81, "sigma": 38.0},
            {"channel": "contact", "share": 0.12, "sigma": 9.0},
            {"channel": "environment", "share": -0.01, "sigma": -0.2},
        )
        if found
        else (),
        "invariances": (
            {
                "invariance": "speed",
                "first": NAMES[0],
                "second": NAMES[1],
                "difference_um": 7.9,
                "difference_deg": 1.6,
                "sigma": 11.0 if found else 0.7,
                "predicted_sigma": 10.4 if extended else None,
            },
        ),
        "covariates": (
            {
                "component": "theta",
                "frame": "part",
                "covariate": "speed",
                "correlation": -0.83,
                "p_value": 0.0004,
            },
        )
        if found
        else (),
        "catch_all_sigma": 1.01 if found else None,
        "held_out": held_out(before, after),
        "next_experiment": {
            "why": "It splits what is left & shows more.",
            "push": {"edge": 2, "place": 0.5, "speed_um_s": 225.0, "what": "push faster <225>"},
        },
        "provenance": {
            "recordings_sha256": "0" * 64,
            "seed": 5,
            "quick": True,
            "meso_robust": "0.1.0",
            "notes": ("push_03.csv: a <note>",),
        },
    }
    return DiagnosisDocument.model_validate({**given, **changes})


def graded(verdict: Verdict) -> dict[str, Any]:
    """What is explained of recordings left out of the fit, as a verdict of this kind has it."""
    share = {"named": 0.93, "partial": 0.55, "ambiguous": 0.9}.get(verdict)
    found = verdict != "consistent"
    left = 1.0 - (share or 0.0)
    effect = {"named": "dry_friction", "partial": "dry_friction", "ambiguous": "body_force"}
    rows = [("", "contact", "one_point", "y", 0.6 * left), ("", "contact", "rest", "x", 0.4 * left)]
    if share:
        stage = "environment" if verdict == "ambiguous" else "support"
        rows.append((effect[verdict], stage, "one_point", "theta", share))
    keys = ("effect", "stage", "phase", "component", "share")
    return {
        "explained": {"share": share, "low": share - 0.06, "high": share + 0.041, "folds": 6}
        if share
        else None,
        "remainder": {
            "um": 0.52,
            "deg": 0.031,
            "sigma": 0.4,
            "stage": "contact" if found else None,
            "component": "y" if found else None,
            "phase": "one_point" if found else None,
            "grows_with": "<speed>" if found else "",
            "spread_between_pushes": 0.3,
        },
        "budget": tuple(dict(zip(keys, row, strict=True)) for row in rows) if found else (),
        "relevant_um": 0.74,
        "explainable_um": 5.21 if found else 0.55,
    }


def candidate(
    effects: tuple[str, ...], gain: float, probability: float, adequate: bool, rejected: str
) -> dict[str, Any]:
    return {
        "effects": effects,
        "gain": gain,
        "chi2": 2500.0 - gain,
        "probability": probability,
        "adequate": adequate,
        "rejected": rejected,
    }


def held_out(before: float, after: float) -> dict[str, Any]:
    """Four recordings, two of them of another speed."""
    return {
        "recordings": HELD_OUT,
        "baseline_sigma": before,
        "extended_sigma": after,
        "noise_floor_sigma": 1.0,
        "repeatability_sigma": 0.07,
        "baseline_um": 1.2 * before,
        "extended_um": 1.2 * after,
        "improvement_low": 0.66 if after < before else 0.0,
        "improvement_high": 0.78 if after < before else 0.0,
        "extrapolation": "the speed 225 µm/s",
        "extrapolation_recordings": EXTRAPOLATION,
        "extrapolation_baseline_sigma": 1.3 * before,
        "extrapolation_extended_sigma": 1.1 * after,
        "black_box_sigma": 2.4,
        "each": tuple(
            {
                "recording": name,
                "split": "extrapolation" if name in EXTRAPOLATION else "held_out",
                "baseline_sigma": before * (0.8 + 0.1 * k),
                "extended_sigma": after * (1.1 - 0.05 * k),
                "baseline_um": 1.2 * before * (0.8 + 0.1 * k),
                "extended_um": 1.2 * after * (1.1 - 0.05 * k),
            }
            for k, name in enumerate(HELD_OUT)
        ),
    }
