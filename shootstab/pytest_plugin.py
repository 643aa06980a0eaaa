"""The plugin for pytest: the fixture `shootstab_baseline`, and the option --shootstab-regen that writes the baselines anew.

def test_spectrum(shootstab_baseline):
    shootstab_baseline("poiseuille", my_eigenvalues(), digits=8)

The first time, and with --shootstab-regen, every eigenvalue is put to `verify`, and those that it confirms are written to
baselines/NAME_OF_THE_TEST.toml beside the test; one that it does not confirm fails. From then on the spectrum is compared with that file,
which takes no time; a file that is not there fails with the command that makes it.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import pytest

Check = Callable[..., None]


def pytest_addoption(parser: pytest.Parser) -> None:
    """--shootstab-regen."""
    group = parser.getgroup("shootstab")
    group.addoption("--shootstab-regen", action="store_true", help="prove the spectra of shootstab_baseline anew, and write their files")


@pytest.fixture
def shootstab_baseline(request: pytest.FixtureRequest) -> Check:
    """check(scene, eigenvalues, digits=8): see the head of this module. Several calls in one test have files of their own."""
    calls = 0

    def check(scene: Any, eigenvalues: Iterable[complex], digits: int = 8) -> None:
        __tracebackhide__ = True
        nonlocal calls
        calls += 1
        name = re.sub(r"[^\w.-]+", "-", request.node.name).strip("-") + (f"-{calls}" if calls > 1 else "")
        path = request.path.parent / "baselines" / f"{name}.toml"
        claimed = [complex(sigma) for sigma in eigenvalues]
        if request.config.getoption("--shootstab-regen"):
            _record(scene, claimed, digits, path)
            return
        _compare(claimed, path)

    return check


def _record(scene: Any, claimed: list[complex], digits: int, path: Path) -> None:
    from shootstab.io import baselines
    from shootstab.testing import assert_spectrum

    __tracebackhide__ = True
    report = assert_spectrum(scene, claimed, digits=digits)
    modes = [(complex(v.sigma), float(v.error or 0.0)) for v in report.verdicts if v.sigma is not None]
    path.parent.mkdir(exist_ok=True)
    baselines.save(baselines.Baseline.of(scene if isinstance(scene, str) else type(scene).__name__, modes, digits), path)


def _compare(claimed: list[complex], path: Path) -> None:
    from shootstab.core.numerus import number_of
    from shootstab.io import baselines

    __tracebackhide__ = True
    if not path.exists():
        pytest.fail(f"{path} is not there: run pytest with --shootstab-regen to prove the spectrum and write it", pytrace=False)
    bad = [difference.line for difference in baselines.load(path).differences(claimed) if not difference.holds]
    if bad:
        drifted = number_of(len(bad), f"mode of {path} has drifted", f"modes of {path} have drifted")
        pytest.fail("\n".join([f"{drifted}:", *bad]), pytrace=False)
