"""Section 2.2: the far field (2.15)-(2.16), its form at a truncation (2.20)-(2.22), and what other conditions there do.

Forterre & Pouliquen (2002) let û, v̂, ŵ and T̂ decay as e^{−Kz} at the truncation z_m, each by itself. With these four conditions the
equations are a problem of one's own on [0, z_m], of which the modes are found and held against those of the half-space; as a control the
same is done with (2.20)-(2.22). z_m is that of the paper, ν0(z_m) = 1e-10, if nothing else is said.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
import sympy as sp
from claims import Case
from scenes import GUESS, problem

import shootstab as st
from paper.pictures import BLUE, GREEN, ORANGE, panels, save
from paper.rows import Item, Reproduction, Row, if_all_hold, write_csv
from paper.truncation import NU_TRUNCATION, truncated
from shootstab.models.chute.far_field import decay_matrix

WAVES = {"high": (0.0, 0.0100), "mid": (0.0, 0.0125), "low": (0.011, 0.0)}  # published: section 3.2, the most unstable ones
FACTORS = np.geomspace(0.02, 1.4, 12)  # chosen: multiples of the most unstable wavenumber, over which the mode of each flow is followed
QUICK_FACTORS = np.geomspace(0.5, 1.0, 3)  # chosen: steps over which a mode is followed without fail
HEIGHTS = (3.0, 5.0, 10.0, 20.0)  # chosen: z_m in T_∞; the paper has more than 20
SHOWS = 1e-3  # chosen: a relative change that shows in the third digit
ALIKE = 1e-5  # chosen: relative change that the truncation by (2.20)-(2.22) may make
GRAINS = 30.0  # published: section 4.1, the wavelength in grain diameters of the instabilities of Forterre & Pouliquen
COLOURS = {"high": BLUE, "mid": ORANGE, "low": GREEN}
U10, U11, W10, T10, KX, KY, Z = sp.symbols("U10 U11 W10 T10 k_x k_y z")
K = sp.sqrt(KX**2 + KY**2)


def solution() -> tuple[sp.Matrix, sp.Expr]:
    """(û, v̂, ŵ) and T̂ of (2.15) with (2.16)."""
    V10 = -KX / KY * U10 - sp.I * K / KY * W10 - 7 * K / (KX * KY) * U11
    V11, W11 = KY / KX * U11, sp.I * K / KX * U11
    decay = sp.exp(-K * Z)
    return sp.Matrix([U10 + U11 * Z, V10 + V11 * Z, W10 + W11 * Z]) * decay, T10 * decay


def same_space(quick: bool) -> Row:
    """(2.15)-(2.16) put into (2.20)-(2.22), and into the equations (A 32)-(A 35), with symbols."""
    velocity, temperature = solution()
    u, v, w = velocity
    a = sp.Matrix(
        [
            [(8 * KX**2 + 7 * KY**2) / (7 * K), KX * KY / (7 * K), sp.I * KX / 7],
            [KX * KY / (7 * K), (7 * KX**2 + 8 * KY**2) / (7 * K), sp.I * KY / 7],
            [sp.I * KX / 7, sp.I * KY / 7, 6 * K / 7],
        ]
    )
    third = sp.Rational(1, 3)
    quarter = sp.Rational(1, 4)
    equations = (
        u.diff(Z, 2) + third * sp.I * KX * w.diff(Z) - (4 * third * KX**2 + KY**2) * u - third * KX * KY * v,
        v.diff(Z, 2) + third * sp.I * KY * w.diff(Z) - third * KX * KY * u - (KX**2 + 4 * third * KY**2) * v,
        w.diff(Z, 2) + quarter * sp.I * (KX * u.diff(Z) + KY * v.diff(Z)) - 3 * quarter * K**2 * w,
        temperature.diff(Z, 2) - K**2 * temperature,
    )
    left = [*(velocity.diff(Z) + a * velocity), temperature.diff(Z) + K * temperature]
    coefficients = sp.Matrix([*velocity, temperature]).subs(Z, 0).jacobian([U10, U11, W10, T10])
    matrix = sp.lambdify((KX, KY), a)(0.3, -0.7) - decay_matrix(0.3, -0.7)[:3, :3]
    cases = (
        Case("(2.15)-(2.16) in (2.20)-(2.22)", "0", str({sp.simplify(e) for e in left}).strip("{}"), 0.0),
        Case("(2.15)-(2.16) in (A 32)-(A 35)", "0", str({sp.simplify(e) for e in equations}).strip("{}"), 0.0),
        Case("dimension of (2.15)-(2.16)", "4", str(coefficients.rank()), 0.0),
        Case("(2.21) is K I − s sᵀ/(7K), s = (ik_x, ik_y, −K)", "yes", "yes" if np.abs(matrix).max() < 1e-15 else "no", 0.0),
    )
    said = if_all_hold(cases, "the same space of dimension 4, symbolically; (2.16) divides by k_x and k_y, K I − s sᵀ/(7K) only by K")
    return Row(
        "(2.15)-(2.16) and (2.20)-(2.22) are one space",
        "2.2, 2.3",
        "the general solution of (2.20) has the decay of (2.15)-(2.16)",
        said,
        cases,
    )


@dataclass(frozen=True)
class Compared:
    """One wave: the mode of the half-space, of (2.20)-(2.22) at z_m, and of exponential decay at z_m."""

    kx: float
    ky: float
    true: complex
    paper: complex
    exponential: complex

    @property
    def changes(self) -> tuple[float, float]:
        """|σ/σ_true − 1| by (2.20)-(2.22) and by exponential decay."""
        return abs(self.paper / self.true - 1), abs(self.exponential / self.true - 1)


def compared(name: str, factor: float, guess: complex, z_m: float | None = None) -> Compared:
    """A flow at its most unstable wavenumbers times a factor."""
    flow = problem(name).flow
    kx, ky = (factor * k for k in WAVES[name])
    p = st.chute.problem(flow, kx, ky)
    true = complex(_settled(p, guess))
    top, k = flow.height(NU_TRUNCATION) if z_m is None else z_m, math.hypot(kx, ky)
    paper, exponential = (complex(_settled(truncated(p, top, d), true)) for d in (decay_matrix(kx, ky), k * np.eye(4)))
    return Compared(kx, ky, true, paper, exponential)


def _settled(p: Any, guess: complex) -> complex:
    mode = st.refine(p, guess=guess, rtol=1e-7)
    if not mode.converged:
        raise RuntimeError(f"{mode.status} from {guess}")
    return complex(mode.sigma)


@cache
def followed(name: str, quick: bool) -> tuple[Compared, ...]:
    """The mode of a flow from its most unstable wavenumbers towards smaller and larger ones, by rising wavenumber."""
    factors = QUICK_FACTORS if quick else FACTORS
    first = int(np.abs(factors - 1).argmin())
    found: dict[int, Compared] = {}
    for way in (range(first, -1, -1), range(first + 1, len(factors))):
        for i in way:
            near = found.get(i - way.step)
            # growth rates are nearly proportional to small wavenumbers
            guess = GUESS[name] if near is None else near.true * (factors[i] / factors[i - way.step] if way.step < 0 else 1.0)
            found[i] = compared(name, float(factors[i]), guess)
    return tuple(found[i] for i in sorted(found))


def growth_rates(quick: bool) -> Row:
    """The published growth rates with exponential decay at z_m in place of (2.20)-(2.22)."""
    cases, said = [], []
    for name in WAVES:
        found = compared(name, 1.0, GUESS[name])
        change = found.changes[1]
        cases.append(Case(f"{name}: moved by more than {SHOWS:g}", "yes", "yes" if change > SHOWS else "no", 0.0, f"{change:.1e}"))
        cases.append(Case(f"{name}: σ by exponential decay", found.true, found.exponential, None))
        said.append(f"{name} {found.true.real:.6f} → {found.exponential.real:.6f} ({change:.1%})")
    return Row(
        "pure exponential decay of û, v̂, ŵ and T̂ is another problem than (2.15)-(2.16): the published growth rates with it",
        "2.2",
        "here our analysis diverges from the previous studies; no number",
        "; ".join(said),
        tuple(cases),
        note=if_all_hold(cases, "each mode stays, and moves"),
    )


def strong_at_small_wavenumbers(quick: bool) -> Row:
    """Along each flow's own mode: where the change shows, and where it is largest; and at the wavelength of Forterre & Pouliquen."""
    files: tuple[str, ...] = ()
    curves = {name: followed(name, quick) for name in WAVES}
    short = at_short_waves(quick)
    worst = {name: max(c.changes[1] for c in found) for name, found in curves.items()}
    peak = {name: max(found, key=lambda c: c.changes[1]) for name, found in curves.items()}
    shown = all(change > SHOWS for change in worst.values())
    if not quick:
        figure, axes = panels(1, 1, (6.4, 4.4))
        panel = axes[0, 0]
        for name, found in curves.items():
            k = [math.hypot(c.kx, c.ky) for c in found]
            panel.loglog(k, [c.changes[1] for c in found], "o-", color=COLOURS[name], markersize=3, label=f"{name}: exponential decay")
            panel.loglog(k, [c.changes[0] for c in found], ":", color=COLOURS[name], label=f"{name}: (2.20)-(2.22)")
        panel.axhline(SHOWS, color="0.6", linewidth=0.8)
        panel.set_xlabel("wavenumber K d")
        panel.set_ylabel("relative change of σ")
        panel.set_title("Conditions at the truncation $z_m$, ν$_0$ = 1e−10", fontsize="medium")
        panel.legend(frameon=False, fontsize="x-small", ncols=2)
        data = [(name, c) for name, found in curves.items() for c in found]
        columns = {
            "flow": [name for name, _ in data],
            "kx": [c.kx for _, c in data],
            "ky": [c.ky for _, c in data],
            "re": [c.true.real for _, c in data],
            "im": [c.true.imag for _, c in data],
            "change_2_20": [c.changes[0] for _, c in data],
            "change_exponential": [c.changes[1] for _, c in data],
        }
        files = (save(figure, "far_field.png"), write_csv("far_field.csv", columns))
    falls = worst["low"] > 10 * short.changes[1]
    cases = (
        Case("changes σ by more than 1e-3 at small wavenumbers, each flow", "yes", "yes" if shown else "no", 0.0),
        Case(
            f"at a wavelength of {GRAINS:g} d less than a tenth of that (low)",
            "yes",
            "yes" if falls else "no",
            0.0,
            f"{short.changes[1]:.1e} at k_x = {short.kx:.3g}",
        ),
    )
    said = "; ".join(
        f"{name} at most {worst[name]:.1%}, at K = {math.hypot(peak[name].kx, peak[name].ky):.2g}, over {SHOWS:g} for K {_range(found)}"
        for name, found in curves.items()
    )
    return Row(
        f"the far-field conditions have a particularly strong influence at small wavenumbers: more than at a wavelength of {GRAINS:g} d",
        "1, 2.2",
        "particularly strong",
        f"{said}; {short.changes[1]:.1e} at a wavelength of {GRAINS:g} d",
        cases,
        note=if_all_hold(cases, "the influence is one of long waves, but weak: none of these modes is lost by it"),
        figures=files,
    )


def enhanced_at_long_wavelength(quick: bool) -> Row:
    """Whether the change grows with the wavelength, from the most unstable wave of each flow on, relative to σ or as it is."""
    cases, said = [], []
    for name in WAVES:
        long = [c for c in followed(name, quick) if math.hypot(c.kx, c.ky) <= math.hypot(*WAVES[name])]
        relative, whole = ([f(c) for c in long] for f in (lambda c: c.changes[1], lambda c: abs(c.exponential - c.true)))
        for label, change in (("relative to σ", relative), ("of σ itself", whole)):
            grows = change[0] > change[-1]
            cases.append(Case(f"{name}: change {label} larger at the longest wave", "yes", "yes" if grows else "no", 0.0))
        last = math.hypot(long[0].kx, long[0].ky)
        said.append(f"{name} {relative[-1]:.1e} at K = {math.hypot(long[-1].kx, long[-1].ky):.2g}, {relative[0]:.1e} at {last:.1g}")
    return Row(
        "the contrast between exponential decay and (2.15) is enhanced at long wavelength",
        "4.1",
        "enhanced at these small wavenumbers",
        f"change of σ relative to it: {'; '.join(said)}",
        tuple(cases),
        note="with (2.20)-(2.22) at the same truncation σ changes by "
        f"{max(c.changes[0] for name in WAVES for c in followed(name, quick)):.0e} at most",
    )


def _range(found: tuple[Compared, ...]) -> str:
    """Wavenumbers of the sample between which the change shows."""
    shown = [math.hypot(c.kx, c.ky) for c in found if c.changes[1] > SHOWS]
    return f"from {min(shown):.2g} to {max(shown):.2g}" if shown else "nowhere"


@cache
def at_short_waves(quick: bool) -> Compared:
    """The mode of the low flow, followed in k_x to a wavelength of 30 grains."""
    target = 2 * math.pi / GRAINS / WAVES["low"][0]
    sigma, before = GUESS["low"], 1.0
    for factor in np.geomspace(1.0, target, 12)[1:]:
        # the frequency is nearly proportional to k_x
        sigma = _settled(
            st.chute.problem(problem("low").flow, WAVES["low"][0] * float(factor), 0.0), complex(sigma.real, sigma.imag * factor / before)
        )
        before = factor
    return compared("low", float(target), sigma)


def nearer_truncation(quick: bool) -> Row:
    """The high flow at its most unstable wavenumber with the domain cut off lower."""
    flow = problem("high").flow
    found = {h: compared("high", 1.0, GUESS["high"], h * flow.far_temperature) for h in HEIGHTS}
    cases = [
        Case("z_m = 20 T∞: σ by (2.20)-(2.22)", found[20.0].true, found[20.0].paper, ALIKE),
        *(Case(f"z_m = {h:g} T∞", f.true, f.exponential, None, f"(2.20)-(2.22) {f.changes[0]:.1e}") for h, f in found.items()),
    ]
    said = ", ".join(f"{h:g} T∞: {f.changes[0]:.0e} and {f.changes[1]:.0e}" for h, f in found.items())
    return Row(
        "z_m/T∞ > 20 suffices for the leading order (high)",
        "2.3",
        "it is sufficient to take the leading-order behaviour by assuming z_m/T∞ ≫ 1",
        f"change of σ by (2.20)-(2.22) and by exponential decay, {said}",
        tuple(cases),
    )


def overprescribed(quick: bool) -> Row:
    """U11 of the true modes, which pure exponential decay of a solution would have to be zero; and how many conditions are left."""
    cases = []
    said = []
    for name, wave in WAVES.items():
        p = problem(name)
        found = st.eigenfunction(p, st.refine(p, guess=GUESS[name], rtol=1e-9), rtol=1e-7)
        k = math.hypot(*wave)
        z = p.flow.height(NU_TRUNCATION)
        at = found(np.array([z]))
        alpha = np.array([complex(at[u][0]) for u in ("u", "v", "w")])
        s = np.array([1j * wave[0], 1j * wave[1], -k])
        # velocities e^{−Kz}(α + s (s·α) z/(7K)): the part that grows with z, over one length 1/K, against the whole
        part = float(np.linalg.norm(s) * abs(s @ alpha) / (7 * k * k) / np.linalg.norm(alpha))
        cases.append(Case(f"{name}: U11 is not zero", "yes", "yes" if part > 1e-3 else "no", 0.0, f"s·α |s|/(7K²|α|) = {part:.2e}"))
        said.append(f"{name} {part:.1e}")
    return Row(
        "U11 = 0 overprescribes: three decaying solutions are left, and four rows at the base",
        "2.2",
        "together with the enforced exponential decay, it is possible that the system was overprescribed",
        f"part of the velocity that is linear in z, over 1/K: {', '.join(said)}; "
        + if_all_hold(cases, "none of the three modes has U11 = 0"),
        tuple(cases),
        note="with V10 independent there are four conditions again, which no solution of the equations fulfils beyond z_m",
    )


def verdicts(quick: bool) -> Row:
    """What `verify` says of the modes of exponential decay, to five digits."""
    cases, said = [], []
    for name in WAVES:
        found = compared(name, 1.0, GUESS[name])
        report = st.verify(problem(name), [found.exponential], digits=5, region=st.Rectangle(1 + 1j, 2 + 2j))
        verdict = report.verdicts[0]
        cases.append(Case(f"{name}: verdict", "inaccurate", verdict.verdict, 0.0, verdict.why))
        said.append(f"{name}: {verdict.verdict}")
    return Row(
        "verdicts on the modes of exponential decay, five digits asked for",
        "2.2",
        "no number; their modes should be those of the chute, but wrong in some digit",
        ", ".join(said),
        tuple(cases),
    )


def two_more(quick: bool) -> Row:
    """The paper does not say which."""
    return Row(
        "the two artificial boundary conditions that made ten of eight",
        "2.2",
        "two artificial boundary conditions were added to the system to provide 10",
        "",
        reason="the paper does not say which conditions they are",
    )


REPRODUCTION = Reproduction(
    "far_field",
    "The far field, and other conditions there",
    (
        Item("one space", same_space),
        Item("growth rates", growth_rates),
        Item("small wavenumbers", strong_at_small_wavenumbers),
        Item("long waves", enhanced_at_long_wavelength),
        Item("truncation", nearer_truncation, in_quick=False),
        Item("overprescribed", overprescribed),
        Item("verdicts", verdicts),
        Item("two more", two_more),
    ),
)
