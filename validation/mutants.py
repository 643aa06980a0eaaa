"""Every entry of what the program computes with, changed by a sign or by 1e-6 of itself: does a fast test fail?

`python validation/mutants.py` changes one entry after another of the pencil C0, C1, D0, D1, of the background's jets, of the wall rows and
the matrices that they are made of, of the far field's series and its σ-derivative, of the reduction to A(σ), of the first-order form of
written equations, of the pencils and end conditions of the gallery, of the tableau, and of the error budget, and runs the tests of that
part in this process until one fails. A survivor is an entry that may be wrong without anybody noticing; a mutant of the gallery that has
the same modes is none. `--group NAME` takes one part, `--quick` every 7th mutant, or 35th of the gallery. Exit status 1 if one survives.
"""

from __future__ import annotations

import argparse
import contextlib
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields, replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

TESTS = Path(__file__).parent.parent / "tests"
for folder in ("", "models/chute", "models/gallery", "discriminants", "kernels", "analyses", "formulation"):
    sys.path.insert(0, str(TESTS / folder))

SIGN, SLIGHT = -1.0, 1.0 + 1e-6  # chosen
FACTORS = {"sign": SIGN, "1e-6": SLIGHT}
EVERY, EVERY_MODE = 7, 35  # chosen: mutants of the short form; of those whose test is a mode, which takes a fifth of a second
OTHER_GUESSES = (0.3, 0.3j, 3.0, 3.0j, -3.0)  # chosen: factors of a mode, from which others are found
ROUNDING = 1e-14  # chosen: part of the largest entry of an array
OF_A_CLASS = ("plane Poiseuille",)  # a class of its own, and no pencil function; its rows have one entry each
# the function of another problem here with other numbers, but for mack: a mode of it takes seconds, and is that of Malik 3
SAME_FUNCTION = ("plate, Malik 6", "plate, Malik 6, Stokes", "Pöschl–Teller, ν = 0.02", "Davies, n = 8", "mack")

Place = tuple[Any, ...]
Test = Callable[[], object]


@dataclass(frozen=True)
class MutantGroup:
    """What is changed, by its name in a module; the places in it that are not zero; how one is changed; the tests, quick ones first;
    and whether a survivor is the same problem in other units or signs of its unknowns, which no test could tell."""

    name: str
    module: Any
    attribute: str
    places: Callable[[], list[Place]]
    changed: Callable[[Any, Place, float], Any]
    tests: list[Test]
    equivalent: Callable[[Any], bool] | None = None

    def mutants(self) -> Iterator[tuple[str, Any]]:
        """Each with its name."""
        for place in self.places():
            for how, factor in FACTORS.items():
                yield f"{self.name}{list(place)} {how}", self.changed(getattr(self.module, self.attribute), place, factor)

    def killed(self, mutant: Any) -> bool:
        """Whether a test fails with the mutant in place."""
        original = getattr(self.module, self.attribute)
        setattr(self.module, self.attribute, mutant)
        try:
            return not all(passes(test) for test in self.tests)
        finally:
            setattr(self.module, self.attribute, original)


def passes(test: Test) -> bool:
    """Whether it ends without an error."""
    try:
        with np.errstate(all="ignore"), contextlib.redirect_stderr(None):
            test()
    except Exception:
        return False
    return True


# entries of arrays, of tuples of them, and of dictionaries by place


def places_of(value: Any, at: Place = ()) -> list[Place]:
    """Where there is a number other than 0, and other than the rounding of a 0."""
    if isinstance(value, tuple | list) and not isinstance(value, np.ndarray):
        return [place for i, part in enumerate(value) for place in places_of(part, (*at, i))]
    if isinstance(value, dict):
        return [(*at, key) for key in value]
    sizes = np.abs(np.asarray(value))
    return [(*at, tuple(int(i) for i in index)) for index in np.argwhere(sizes > ROUNDING * sizes.max(initial=0.0))]


def with_change(value: Any, place: Place, factor: float) -> Any:
    """The same with that entry multiplied."""
    first, rest = place[0], place[1:]
    if isinstance(value, dict):
        return {key: entry * factor if key == first else entry for key, entry in value.items()}
    if isinstance(value, tuple | list):
        return type(value)(with_change(part, rest, factor) if i == first else part for i, part in enumerate(value))
    out = np.array(value)
    out[first] = out[first] * factor
    return out


def returned(function: Callable[..., Any], place: Place, factor: float) -> Callable[..., Any]:
    """The function with that entry of what it returns changed, where there is one."""

    def mutant(*given: Any, **named: Any) -> Any:
        return with_change(function(*given, **named), place, factor)

    mutant.cache_clear = lambda: None  # type: ignore[attr-defined]
    return mutant


# the parts


def pencil() -> MutantGroup:
    import test_first_order_system as t

    def proved() -> None:
        t.symbolic_pencil.cache_clear()
        t.test_pencil_is_the_linearization_of_the_governing_equations()

    def places() -> list[Place]:
        return places_of(t.pencil_entries(t.symbolic_background(), t.TAN, t.KX, t.KY))

    steps = [lambda T=T: t.test_pencil_against_complex_step_of_the_nonlinear_equations(T) for T in (2.54, 0.2)]
    return MutantGroup("pencil", t, "pencil_entries", places, returned, [*steps, proved])


def jets() -> MutantGroup:
    import test_first_order_system as t

    def changed(background: Any, place: Place, factor: float) -> Any:
        name, order = place

        def mutant(*given: Any) -> Any:
            bg = background(*given)
            old = getattr(bg, name).coefficients
            return replace(bg, **{name: type(bg.nu)(c * factor if i == order else c for i, c in enumerate(old))})

        return mutant

    places: list[Place] = [(f.name, order) for f in fields(t.Background) for order in (0, 1)]
    tests = [lambda s=s: t.test_background_jets_follow_from_the_steady_equations(t.PAPER, s) for s in t.STATES]
    return MutantGroup("jets", t, "background", lambda: places, changed, tests)


def wall(attribute: str) -> MutantGroup:
    import test_wall as t

    def places() -> list[Place]:
        bg = t.background(t.CHUTES[1], *t.STATES[0], np.pi)
        return places_of(getattr(t, attribute)(t.CHUTES[1], bg, 0.37, 0.21, np.pi))

    test = {"wall_rows": t.test_wall_rows_in_psi, "base_matrices": t.test_base_matrices_are_the_linearization}[attribute]
    digits = [lambda w=w: t.test_wall_rows_hold_forty_digits(w) for w in ("isotropic", "printed")]
    return MutantGroup(attribute, t, attribute, places, returned, [*(lambda s=s: test(t.CHUTES[1], s) for s in t.STATES), *digits])


def far_field() -> MutantGroup:
    import test_far_field as t

    def changed(original: Any, place: Place, factor: float) -> Any:
        class Mutant(original):  # type: ignore[misc,valid-type]
            def terms(self, *given: Any) -> Any:
                return with_change(super().terms(*given), place, factor)

        return Mutant

    def places() -> list[Place]:
        return places_of(t.FarField(t.CHUTE, t.TEMPERATURE, t.VELOCITY, *t.WAVES[0]).terms(t.SIGMAS[0]))

    tests = [lambda w=w: t.test_the_series_solves_the_system_and_its_tangent_the_derivative_of_it(*w, t.SIGMAS[0]) for w in t.WAVES]
    return MutantGroup("far field", t, "FarField", places, changed, tests)


def exponents() -> MutantGroup:
    import test_far_field as t

    tests = [lambda w=w: t.test_the_exponents_are_those_of_2_20_to_2_22(*w) for w in t.WAVES]
    return MutantGroup("exponents", t, "decay_matrix", lambda: places_of((t.decay_matrix(0.3, 0.2),)), _only, tests)


def _only(function: Callable[..., Any], place: Place, factor: float) -> Callable[..., Any]:
    """The place of the result of a function that returns one array."""
    return lambda *given: with_change((function(*given),), place, factor)[0]


def flow_series() -> MutantGroup:
    import test_far_field as t

    def places() -> list[Place]:
        _, *others = t.flow_series(t.CHUTE, t.TEMPERATURE, t.VELOCITY, t.FAR_TERMS, np.pi)
        return [(0, (1,)), *((i, (m,)) for i, f in enumerate(others, 1) for m in range(t.FAR_TERMS) if f[m] != 0)]

    def changed(function: Any, place: Place, factor: float) -> Any:
        def mutant(*given: Any) -> Any:
            found = function(*given)
            series = type(found[0])
            lists = [list(f.coefficients) for f in found]
            lists[place[0]][place[1][0]] *= factor
            return tuple(series(c) for c in lists)

        return mutant

    return MutantGroup(
        "flow series", t, "flow_series", places, changed, [t.test_the_series_of_the_flow_obeys_the_steady_equations_at_every_order]
    )


def reduction(case: tuple[int, list[int], list[int]]) -> MutantGroup:
    import test_sampled_system as t

    n, moving, columns = case
    tests: list[Test] = [lambda: t.test_the_reduction_is_the_inverse_of_C_times_D(n, moving, columns)]
    places = lambda: places_of(t.reduce_pencil(t.random_pencil(n, moving, columns, seed=n), n))  # noqa: E731
    return MutantGroup(f"reduction {n}", t, "reduce_pencil", places, returned, tests)


def written(name: str) -> MutantGroup:
    """The first-order form of equations as a user writes them, by their exact coefficients."""
    import test_reduction as t

    from shootstab.formulation.expression import number

    def changed(function: Any, place: Place, factor: float) -> Any:
        part, key = place

        def mutant(*given: Any) -> Any:
            found = function(*given)
            return replace(found, **{part: {k: e * number(factor) if k == key else e for k, e in getattr(found, part).items()}})

        return mutant

    def places() -> list[Place]:
        first = t.made(t.WRITTEN[name])[1]
        return [(part, key) for part in ("C", "D") for key in getattr(first, part)]

    test = lambda: t.test_solutions_of_the_first_order_system_satisfy_the_equations(name)  # noqa: E731
    return MutantGroup(f"written {name}", t, "first_order", places, changed, [test])


def gallery(name: str) -> MutantGroup:
    """The pencil of a problem of the gallery as a function of z, and the rows at its walls."""
    import test_gallery as t

    from shootstab.problems.protocol import Pencil

    (case,) = (c for c in t.PUBLISHED if c.name == name)
    problem = case.problem()

    rows_of = problem.wall_rows() if name in OF_A_CLASS else problem.reduction.rows

    def changed(_: Any, place: Place, factor: float) -> Any:
        part, *at = place

        def pencil(z: Any) -> Any:
            found = problem.pencil(np.atleast_1d(z).astype(complex))
            return with_change((*found.C, *found.D), tuple(at), factor)

        def mutant() -> Any:
            if part == "rows":
                return replace(problem, reduction=replace(problem.reduction, rows=with_change(rows_of, tuple(at), factor)))
            if name in OF_A_CLASS:
                made = type("Mutant", (type(problem),), {"pencil": lambda self, z: Pencil(*pencil(z))})
                return made(**{f.name: getattr(problem, f.name) for f in fields(problem)})
            made = replace(problem, function=replace(problem.function, function=pencil, vectorized=True))
            made.__dict__["recorded"] = None  # the recorded program, which a test holds against the function, knows of no change
            return made

        return mutant

    def places() -> list[Place]:
        at = problem.pencil(np.array([0.31 + 0j, 0.47 + 0j]))
        sizes = [np.abs(m).max(axis=0) for m in (*at.C, *at.D)]
        entries = [("pencil", i, (..., *entry)) for i, entry in places_of(sizes)]
        # a row of one entry says the same times any number
        several = sum(np.count_nonzero(W, axis=1) for W in rows_of) > 1
        return [*entries, *(("rows", *place) for place in places_of(rows_of) if several[place[1][0]])]

    def equivalent(mutant: Any) -> bool:
        """Whether several modes, of which the test knows one, are the same to their bounds."""
        several = [t.st.refine(problem, case.sigma * factor, rtol=1e-9) for factor in OTHER_GUESSES]
        own = [t.st.refine(mutant(), mode.sigma, rtol=1e-9) for mode in several if mode.converged]
        known = [mode for mode in several if mode.converged]
        return all(abs(a.sigma - b.sigma) <= a.error + b.error for a, b in zip(known, own, strict=True))

    here = SimpleNamespace(problem=case.problem)
    return MutantGroup(f"gallery {name}", here, "problem", places, changed, [lambda: t.must_agree(case, here.problem())], equivalent)


def tableau(attribute: str) -> MutantGroup:
    import test_frame_transport as t

    tests: list[Test] = [
        t.test_stages_are_consistent,
        t.test_quadrature_conditions_to_order_8,
        t.test_linear_order_conditions,
        t.test_error_weights_vanish_on_constants_and_see_more,
    ]
    places = lambda: places_of((getattr(t.tableau, attribute),))  # noqa: E731
    changed = lambda value, place, factor: with_change((value,), place, factor)[0]  # noqa: E731
    return MutantGroup(f"tableau {attribute}", t.tableau, attribute, places, changed, tests)


def budget() -> MutantGroup:
    import test_error_budget as t

    def changed(function: Any, place: Place, factor: float) -> Any:
        def mutant(*given: Any) -> Any:
            found = function(*given)
            return replace(found, **{place[0]: getattr(found, place[0]) * factor})

        return mutant

    places: list[Place] = [(name,) for name in ("integration", "far_field", "steady_flow", "root", "rounding")]
    tests: list[Test] = [
        t.test_every_part_is_what_the_variants_move_the_zero_by,
        t.test_rounding_is_sampled_on_the_fine_mesh_where_it_matters,
        t.test_farther_walls_and_the_total,
    ]
    return MutantGroup("budget", t, "budget", lambda: places, changed, tests)


def groups() -> dict[str, list[Callable[[], MutantGroup]]]:
    """The groups by name, in the order in which they are cheap."""
    return {
        "tableau": [lambda a=a: tableau(a) for a in ("A", "B", "C", "E5", "E3")],
        "budget": [budget],
        "reduction": [lambda c=c: reduction(c) for c in ((4, [0, 2], [1, 3]), (3, [1], [2]), (5, [2, 3], [4]))],
        "wall": [lambda a=a: wall(a) for a in ("wall_rows", "base_matrices")],
        "far field": [exponents, flow_series, far_field],
        "jets": [jets],
        "pencil": [pencil],
        "written": [lambda n=n: written(n) for n in written_names()],
        "gallery": [lambda n=n: gallery(n) for n in gallery_names()],
    }


def written_names() -> list[str]:
    from equations_written import WRITTEN

    return list(WRITTEN)


def gallery_names() -> list[str]:
    from test_gallery import PUBLISHED

    return [case.name for case in PUBLISHED if case.name not in SAME_FUNCTION]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--group", action="append", choices=groups(), help="this part (default: all)")
    parser.add_argument("--quick", action="store_true", help=f"every {EVERY}-th mutant")
    options = parser.parse_args()
    survivors: list[str] = []
    total, same, began = 0, 0, time.monotonic()
    for name, made in groups().items():
        if options.group is not None and name not in options.group:
            continue
        count, since = 0, time.monotonic()
        for make in made:
            group = make()
            if not all(passes(test) for test in group.tests):
                raise SystemExit(f"{group.name}: a test fails without any change")
            for number, (title, mutant) in enumerate(group.mutants()):
                if options.quick and number % (EVERY if group.equivalent is None else EVERY_MODE):
                    continue
                count += 1
                if group.killed(mutant):
                    continue
                if group.equivalent is not None and group.equivalent(mutant):
                    same += 1
                    continue
                survivors.append(title)
                print(f"  SURVIVES {title}", flush=True)
        total += count
        print(f"{name:10} {count:5d} mutants, {time.monotonic() - since:.0f} s", flush=True)
    told = f"{same} of them the same problem in other signs or within rounding, {len(survivors)} survive"
    print(f"{total} mutants, {told}, {time.monotonic() - began:.0f} s")
    return bool(survivors)


if __name__ == "__main__":
    sys.exit(main())
