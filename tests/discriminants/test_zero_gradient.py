"""discriminants/zero_gradient: what moves a zero, to first order, against D computed anew for each change."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import shootstab as st
from shootstab.analyses.error_budget import shift
from shootstab.core.discriminant import Value
from shootstab.discriminants.zero_gradient import ZeroGradient

CHANGE = 1e-6  # chosen: relative change of entries, whose square is far below what is compared


def steep() -> Any:
    """u⁗ = σ u″ + …: no flow, real, order 4, with a root of D near −13."""
    walls = st.Conditions(0, ["u", "d(u)"]), st.Conditions(1, ["u", "d(u)"])
    return st.equations(["u"], ["d(u, 4) - sigma*d(u, 2) + 40*x*d(u)"], *walls, variable="x")


PLACES: dict[str, tuple[Any, complex]] = {  # a problem, or the name of a scene, and a σ next to a zero
    "high": ("high", 0.0039705),
    "low": ("low", 0.0072756 - 0.0118650j),
    "fig2": ("fig2", 0.00169243 - 0.00156624j),
    "equations": (steep, -40.0),
}


@pytest.fixture(scope="module", params=list(PLACES))
def placed(request: pytest.FixtureRequest, scenes: dict[str, Any]) -> tuple[Any, Any, Value, ZeroGradient]:
    """The problem, D of the subsystem on a coarse mesh, its value at a zero and the gradient of that."""
    made, sigma = PLACES[request.param]
    problem = scenes[made] if isinstance(made, str) else made()
    D = st.Frame(rtol=1e-6).on(problem).at(sigma)
    for _ in range(8):
        sigma += D.with_derivative(sigma).newton_step
    own = D.vanishing_at(sigma)
    gradient = own.gradient(sigma)
    assert gradient is not None
    return problem, own, own.with_derivative(sigma), gradient


def test_other_entries_move_the_zero_as_the_gradient_says(placed: tuple[Any, Any, Value, ZeroGradient]) -> None:
    _, own, value, gradient = placed
    for seed in (1, 2, 3):
        variant = own.with_perturbed_system(seed, CHANGE)
        told = gradient.shift(variant.ingredients(value.sigma))
        assert told is not None
        assert told == pytest.approx(-shift(variant, value), rel=1e-3)


def test_another_far_frame_moves_the_zero_as_the_gradient_says(placed: tuple[Any, Any, Value, ZeroGradient]) -> None:
    """So does one draw; and the root mean square of many is what is told of them all."""
    _, own, value, gradient = placed
    moved = []
    for seed in range(40):
        variant = own.with_perturbed_start(seed, CHANGE)
        told = gradient.shift(variant.ingredients(value.sigma))
        assert told is not None
        if seed < 3:
            assert told == pytest.approx(-shift(variant, value), rel=1e-3, abs=1e-13 * abs(value.sigma))
        moved.append(abs(told) / CHANGE)
    assert gradient.by_far_frame == pytest.approx(np.sqrt(np.mean(np.square(moved))), rel=0.4, abs=1e-9 * abs(value.sigma))


def test_entries_changed_at_random_come_to_what_is_told_in_the_mean(placed: tuple[Any, Any, Value, ZeroGradient]) -> None:
    _, own, value, gradient = placed
    told = gradient.by_entries
    if told is None:  # C is solved with
        assert placed[1].problem.pencil(own.ingredients(value.sigma).sampled.nodes).C0.any()
        return
    moved = []
    for seed in range(60):
        by = gradient.shift(own.with_perturbed_system(seed, CHANGE).ingredients(value.sigma))
        assert by is not None
        moved.append(abs(by) / CHANGE)
    assert told == pytest.approx(np.sqrt(np.mean(np.square(moved))), rel=0.3)


def test_steps_halved_one_by_one_move_it_by_their_own_shares(placed: tuple[Any, Any, Value, ZeroGradient]) -> None:
    """All together as the halved mesh does, and those of one half as a mesh with this half cut."""
    _, own, value, gradient = placed
    fine = own.refined()
    shares = gradient.by_step(fine.ingredients(value.sigma).sampled)
    assert len(shares) == own.steps
    rest = 1e-14 * abs(value.sigma)
    assert shares.sum() == pytest.approx(-shift(fine, value), rel=1e-3, abs=rest)
    errors = (own if not hasattr(own, "members") else own.members[0]).propagated(value.sigma, True).errors
    ranks = np.argsort(np.argsort(-errors, kind="stable"))
    for digit in (0, 1):
        half = shares[(ranks >> digit) % 2 == 0].sum()
        assert half == pytest.approx(-shift(own.partly_refined(digit, value.sigma), value), rel=1e-3, abs=rest)


def test_rounding_of_the_transport_is_what_other_bases_show(placed: tuple[Any, Any, Value, ZeroGradient]) -> None:
    """To a factor of three either way: the root mean square of eight draws against the sum of squares."""
    _, own, value, gradient = placed
    drawn = [abs(shift(own.with_rotated_basis(seed), value)) for seed in range(1, 9)]
    seen = np.sqrt(np.mean(np.square(drawn))) / np.finfo(float).eps
    assert 1 / 3 < seen / np.hypot(gradient.components, gradient.products) < 3


def test_another_flow_moves_the_zero_as_the_gradient_says(scenes: dict[str, Any]) -> None:
    """A flow of another far temperature has other entries, another far frame and other rows at the wall."""
    problem = scenes["high"]
    flow = problem.flow
    chute = {name: getattr(flow.chute, name) for name in ("e", "e_w", "r", "tan_theta")}
    other = st.chute.problem(st.chute.steady(far_temperature=flow.far_temperature * (1 + 1e-6), **chute), kx=problem.kx, ky=problem.ky)
    sigma = 0.0039705
    D = st.Frame(rtol=1e-8).on(problem).at(sigma)
    for _ in range(8):
        sigma += D.with_derivative(sigma).newton_step
    gradient = D.gradient(sigma)
    assert gradient is not None
    variant = D.on_same_mesh(other)
    told = gradient.shift(variant.ingredients(sigma))
    # another normalization of the far frame has another D, whose own derivative counts
    assert told == pytest.approx(variant.with_derivative(sigma).newton_step, rel=1e-3)


@pytest.mark.parametrize("method", [st.Compound, st.Riccati])
def test_other_methods_have_no_gradient(scenes: dict[str, Any], method: Any) -> None:
    assert method(rtol=1e-6).on(scenes["high"]).at(0.004).gradient(0.004) is None


def test_where_two_subsystems_could_vanish_there_is_none(scenes: dict[str, Any]) -> None:
    D = st.Frame(rtol=1e-6).on(scenes["low"]).at(0.0073 - 0.0119j)
    assert D.gradient(0.0073 - 0.0119j) is None


def test_where_the_wall_lies_behind_a_barrier_there_is_none() -> None:
    """A state of two wells that tunnels: between two neighbouring doubles σ the solution at the second wall turns about."""
    walls = st.Conditions(-2.5, ["y"]), st.Conditions(2.5, ["y"])
    problem = st.equations(["y"], ["0.0064*d(y, 2) - ((x**2 - 1)**2 - sigma)*y"], *walls, variable="x")
    mode = st.refine(problem, 0.1566, rtol=1e-9)
    assert mode.converged
    sigma = complex(mode.sigma)
    D = st.Frame(rtol=1e-10).on(problem).at(sigma)
    for _ in range(3):
        sigma += D.with_derivative(sigma).newton_step
    assert D.gradient(sigma) is None
    fine = st.Frame(rtol=1e-13).on(problem)
    assert abs(sigma + fine.with_derivative(sigma).newton_step - mode.sigma) <= 2 * mode.error
