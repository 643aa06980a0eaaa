"""Woodhouse & Hogg (2010), Part 2, reproduced: a script for each part and figure; `python validation/run.py paper` runs them."""

from __future__ import annotations

# the rows in the order of the table
SCRIPTS = (
    "errata",
    "order_and_continuum",
    "far_field",
    "figure2",
    "figure3",
    "figures456",
    "figure7",
    "edges",
    "gentle_slopes",
    "edge_digits",
    "all_waves",
    "oblique",
    "two_methods",
    "ladder",
    "parameters",
    "extremes",
)
