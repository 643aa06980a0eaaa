"""cli/verdict_looks.py: verdicts are told apart by readers who do not see green, and read on either background."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from shootstab.cli.verdict_looks import MISSING_LOOK, VERDICT_LOOKS

# G. M. Machado, M. M. Oliveira & L. A. F. Fernandes, IEEE Trans. Vis. Comput. Graph. 15 (2009) 1291, table 1, severity 1; linear RGB
SEEN = {
    "all": np.eye(3),
    "deuteranopia": np.array([[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]]),
    "protanopia": np.array([[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]]),
}
LOOKS = {**VERDICT_LOOKS, "missing": MISSING_LOOK}
TO_XYZ = np.array([[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750], [0.0193339, 0.1191920, 0.9503041]])


def linear(colour: str) -> np.ndarray:
    """Linear RGB of #rrggbb, by IEC 61966-2-1."""
    c = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)]) / 255
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)


def lab(rgb: np.ndarray) -> np.ndarray:
    """CIE L*a*b* of linear RGB, by the white of sRGB."""
    t = TO_XYZ @ np.clip(rgb, 0, 1) / TO_XYZ.sum(axis=1)
    x, y, z = np.where(t > (6 / 29) ** 3, np.cbrt(t), t / (3 * (6 / 29) ** 2) + 4 / 29)
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])


@pytest.mark.parametrize("eye", SEEN)
def test_marks_of_two_verdicts_differ_in_colour_and_in_shape(eye: str) -> None:
    """ΔE of 10 is seen at a glance; 2.3 is just noticed."""
    assert len({look.marker for look in LOOKS.values()}) == len(LOOKS)
    for one, other in combinations(LOOKS.values(), 2):
        apart = np.linalg.norm(lab(SEEN[eye] @ linear(one.colour)) - lab(SEEN[eye] @ linear(other.colour)))
        assert apart > 10.0, (one, other, apart)


@pytest.mark.parametrize("eye", SEEN)
@pytest.mark.parametrize(("background", "when"), [("#ffffff", "by_day"), ("#14181d", "by_night")])
def test_words_on_a_page_have_the_contrast_of_text(eye: str, background: str, when: str) -> None:
    """WCAG 2.2, 1.4.3: 4.5 to 1, with the luminance that is left to the eye; the words themselves tell verdicts apart."""
    luminance = [TO_XYZ[1] @ np.clip(SEEN[eye] @ linear(c), 0, 1) for c in (background, *(getattr(k, when) for k in LOOKS.values()))]
    for y in luminance[1:]:
        low, high = sorted((y, luminance[0]))
        assert (high + 0.05) / (low + 0.05) >= 4.5
