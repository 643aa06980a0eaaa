"""A mesh on which the local errors hold for one σ, or for several."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from shootstab.core import polynomial
from shootstab.core.errors import ConvergenceError
from shootstab.discriminants.analyticity import require_analytic
from shootstab.discriminants.deformed_path import DeformedPath
from shootstab.discriminants.mesh import across_knots, fits, redistribute, subdivide
from shootstab.discriminants.method import Propagator
from shootstab.discriminants.sampled_system import SampledSystem, resample, sample_system
from shootstab.discriminants.shooting import MESH_SLACK, Shooting, far_tolerance
from shootstab.kernels.tableau import ORDER
from shootstab.problems.capabilities import KNOTS
from shootstab.problems.knots import find_knots, pair, with_pairs
from shootstab.problems.protocol import ComplexArray, Problem

# the bytes of a sampled system: with the halved mesh (2), its other cuts (2), another base flow (1) and changed entries (2) 1 GiB in all
MOST_BYTES = 2**30 // 8  # derived
MOST_GROWTH = 1.9  # chosen: times the steps of a mesh to which it may be cut for the other end of its cell: nearly every step is halved
MESH_ATTEMPTS = 30  # chosen: attempts at a mesh
REDISTRIBUTIONS = 3  # chosen: the attempts among them, at most, that move every node
SAME_PLACE = 1e-9  # chosen: nodes nearer to each other than this part of the path are one
SHORTEST_STEP = 1e-12  # chosen: steps shorter than this part of the path mean that none is short enough
SMALL_DETERMINANT = 1e-5  # chosen: least of the largest singular value of C below which a place is called singular
RESOLVED_ERROR = 1e-3  # chosen: local errors below this fall with the step, unless the coefficients are not smooth
NOISY_ORDER = 3  # chosen: errors of parts of a step that fall with a lower power of it all over the step tell of noise
KNOT_ORDER = ORDER // 2  # derived: errors of a part of a step that fall with a lower power of it tell of a knot in it
CLOSER_LOOKS = 4  # chosen: steps that are looked at before the mesh is cut again
NOISY_STEPS = 16  # chosen: the number of such steps that is no accident
NOISE_SAFETY = 4.0  # chosen: times the largest error seen that does not fall, what noise is taken to be: others are larger by chance
LOUDEST_NOISE = 1e-6  # chosen: a noise below which D is still worth computing; the bounds on zeros measure what it does to them

Regrid = Callable[[ComplexArray, NDArray[np.float64], float], ComplexArray]


class TooLong(ConvergenceError):  # noqa: N818
    """A mesh would be longer than whoever asks for it wants it; for others it may serve."""


def made_for(
    problem: Problem,
    propagator: Propagator,
    path: DeformedPath | None,
    sigma: complex,
    coarser: Shooting | SampledSystem | None = None,
    smallest: complex | None = None,
    most: int | None = None,
    whole: Problem | None = None,
) -> Shooting:
    """D on a mesh on which the local errors hold at σ: cut from the coarser one, or spread from the problem's own first mesh.

    Where they are rounding, they are held to that. smallest is the other end of the cell whose largest σ is meant: the mesh begins as far
    out as both need, and is cut once where it does not serve that end. whole is the problem that this one is a subsystem of, if it is one.
    Raises TooLong where the mesh would have more steps than most, ConvergenceError where no mesh is found for σ, InputError where the
    pencil is not analytic between the path and the real axis.
    """
    start = _start(problem, propagator, sigma, smallest)
    noise = coarser.noise if isinstance(coarser, Shooting) else 0.0
    known = coarser if isinstance(coarser, Shooting) and coarser.propagator is propagator else None
    if coarser is None:
        straight = problem.mesh(start)
        if path is not None:
            require_analytic(problem if whole is None else whole, path, straight)
        sampled = sample_system(problem, straight.astype(np.complex128) if path is None else path.deform(straight))
        regrids: tuple[Regrid, ...] = (redistribute,) * REDISTRIBUTIONS
    else:
        begin = coarser.sampled if isinstance(coarser, Shooting) else coarser
        sampled, regrids = _begun_at(problem, begin, start), ()
    before: Shooting | None = None
    knots: NDArray[np.float64] = np.zeros(0)
    failed: ComplexArray | None = None
    for turn in range(MESH_ATTEMPTS):
        shooting = known if known is not None and sampled is known.sampled else Shooting(problem, propagator, sampled, noise=noise)
        errors = shooting.propagated(sigma, False).errors
        if turn < len(regrids) and fits(errors, shooting.tolerance):
            regrids = regrids[:turn]
        if turn >= len(regrids):
            if before is not None:
                noise = max(noise, _noise(before, shooting, sigma))
            noise = max(noise, _over_knots(sampled.nodes, errors))
            shooting = shooting.allowing(noise)
            if (errors <= shooting.tolerance).all():
                fixed = _fixed_at(shooting, sigma)
                return fixed if smallest is None else _cut_once(fixed, smallest)
            if before is not None:
                knots = _overlooked(before, shooting, sigma)
            before = shooting
        errors, failed = _told(sampled.nodes, errors, failed)
        cut = turn >= len(regrids)
        sampled = _regridded(shooting, errors, subdivide if cut else regrids[turn], sigma, most if cut else None)
        if len(knots):
            sampled = resample(problem, _with_knots(sampled.nodes, knots), sampled)
    raise ConvergenceError(
        f"no mesh holds local errors of {propagator.rtol:.1e} at sigma = {sigma:.6g}: {_trouble(shooting, errors, sigma)}"
    )


def too_long(sigma: complex, most: int) -> TooLong:
    """What is raised where a mesh is longer than its asker wants it."""
    return TooLong(f"the mesh for sigma = {sigma:.6g} would need more than {most} steps")


def _told(nodes: ComplexArray, errors: NDArray[np.float64], failed: ComplexArray | None) -> tuple[NDArray[np.float64], ComplexArray | None]:
    """The errors (N,) that the next mesh is cut by, and the ends (2,) of the first step that failed; failed are those of the mesh before.

    Behind a step that fails no error is a number. Where it is a part of one that failed before, what is behind tells nothing of its own and
    is not cut: next to a singular point the mesh would grow without bound in vain.
    """
    bad = np.flatnonzero(~np.isfinite(errors))
    if not len(bad):
        return errors, None
    step = nodes[bad[0] : bad[0] + 2]
    if failed is not None and (np.abs(step.mean() - failed) <= abs(failed[1] - failed[0])).all():
        errors = errors.copy()
        errors[bad[1:]] = 0.0
    return errors, step


def cut_for(shooting: Shooting, sigmas: list[complex]) -> Shooting:
    """The same on a mesh cut further until the local errors hold at every σ. Raises ConvergenceError where that does not help."""
    for _ in range(MESH_ATTEMPTS):
        propagations = [shooting.propagated(sigma, True) for sigma in sigmas]
        for sigma, propagation in zip(sigmas, propagations, strict=True):
            if not propagation.sound:
                raise ConvergenceError(f"the charts that suit the middle of a circle do not serve sigma = {sigma:.6g} on it")
        errors = np.max([propagation.errors for propagation in propagations], axis=0)
        if (errors <= MESH_SLACK * shooting.tolerance).all():
            return shooting
        sampled = _regridded(shooting, errors, subdivide, sigmas[0])
        shooting = Shooting(shooting.problem, shooting.propagator, sampled, noise=shooting.noise)
    raise ConvergenceError(f"local errors of {shooting.tolerance:.1e} cannot be held around sigma = {sigmas[0]:.6g}")


def _start(problem: Problem, propagator: Propagator, sigma: complex, smallest: complex | None) -> float:
    """Where a mesh for σ begins; one for a whole cell where its smallest σ needs it, if that is farther out and has such a place."""
    asked = far_tolerance(propagator.rtol)
    start = problem.start(sigma, asked)
    if smallest is None:
        return start
    try:
        other = problem.start(smallest, asked)
    except ConvergenceError:
        return start
    wall = float(problem.mesh(start)[-1])
    return max(start, other, key=lambda z: abs(z - wall))


def _cut_once(shooting: Shooting, sigma: complex) -> Shooting:
    """The same, cut once where the local errors miss at another σ what it may serve with; itself where no value there tells.

    Itself too where the mesh would grow by more than MOST_GROWTH: every σ of the cell would pay for that one, which has a smaller cell.
    """
    try:
        propagation = shooting.propagated(sigma, False)
    except ConvergenceError:
        return shooting
    errors = propagation.errors
    if not (propagation.sound and np.isfinite(errors).all()) or (errors <= MESH_SLACK * shooting.tolerance).all():
        return shooting
    try:
        sampled = _regridded(shooting, errors, subdivide, sigma, int(MOST_GROWTH * shooting.steps))
    except ConvergenceError:
        return shooting
    return Shooting(shooting.problem, shooting.propagator, sampled, noise=shooting.noise)


def _fixed_at(shooting: Shooting, sigma: complex) -> Shooting:
    sampled = shooting.sampled
    far = shooting.problem.far_frame(float(sampled.nodes[0].real), sigma)
    propagator = shooting.propagator.fixed_at(sampled, far, sigma)
    return shooting if propagator is shooting.propagator else Shooting(shooting.problem, propagator, sampled, noise=shooting.noise)


def _begun_at(problem: Problem, known: SampledSystem, start: float) -> SampledSystem:
    """The same mesh, begun farther out if the far frame asks for it."""
    nodes = known.nodes
    outwards = nodes[0].real - nodes[-1].real
    if (start - nodes[0].real) * outwards <= SAME_PLACE * outwards**2:
        return known
    straight = problem.mesh(start)
    beyond = straight[(straight - nodes[0].real) * outwards > SAME_PLACE * outwards**2]
    return resample(problem, np.concatenate((beyond, nodes)), known)


def _regridded(shooting: Shooting, errors: NDArray[np.float64], regrid: Regrid, sigma: complex, wanted: int | None = None) -> SampledSystem:
    """The problem on the next mesh. Raises ConvergenceError where that is too large, or a step of it too short to be one, TooLong where it
    has more steps than are wanted."""
    known = shooting.sampled
    nodes = regrid(known.nodes, errors, shooting.tolerance)
    most = int(MOST_BYTES / max(known.bytes_of_a_step, 1))
    if wanted is not None and len(nodes) > wanted:
        raise too_long(sigma, wanted)
    if len(nodes) > most:
        why = _trouble(shooting, errors, sigma)
        raise ConvergenceError(f"the mesh for sigma = {sigma:.6g} would need more than the {most} steps that memory allows: {why}")
    lengths = np.abs(np.diff(nodes))[~across_knots(nodes)]
    if lengths.min() < SHORTEST_STEP * lengths.sum() or across_knots(nodes).sum() > across_knots(known.nodes).sum():
        raise ConvergenceError(f"no step is short enough at sigma = {sigma:.6g}: {_trouble(shooting, errors, sigma)}")
    return resample(shooting.problem, nodes, known)


def _noise(before: Shooting, after: Shooting, sigma: complex) -> float:
    """NOISE_SAFETY times the local error that does not fall with the step: that of steps that were cut and err as much in all parts.

    0 where there are none. At a jump or a kink one part errs; the others fall with the order of the method. Noise is rounding of a row of
    the frame that would be 0 in exact arithmetic, or of the coefficients. Raises ConvergenceError where it is louder than LOUDEST_NOISE.
    """
    first = np.flatnonzero(np.isin(after.sampled.nodes[:-1], before.sampled.nodes[:-1]))
    old = before.propagated(sigma, False).errors
    if len(first) != len(old):
        return 0.0
    parts = np.diff(np.append(first, after.steps))
    least = np.minimum.reduceat(after.propagated(sigma, False).errors, first)
    noisy = (parts > 1) & (old < RESOLVED_ERROR) & (least > after.tolerance) & (least > old / parts**NOISY_ORDER)
    if np.count_nonzero(noisy) < NOISY_STEPS:
        return 0.0
    noise = NOISE_SAFETY * float(old[noisy].max())
    if noise > LOUDEST_NOISE:
        at = before.sampled.nodes[:-1][noisy]
        z, near = at.real, _nearly_singular(before, at, sigma).any()
        raise ConvergenceError(
            f"between z = {z.min():.6g} and {z.max():.6g} local errors of {noise / NOISE_SAFETY:.1e} do not fall with the step: "
            + (f"C is nearly singular there at sigma = {sigma:.6g}" if near else "they are rounding, or noise in the coefficients")
        )
    return noise


def _over_knots(nodes: ComplexArray, errors: NDArray[np.float64]) -> float:
    """The largest local error of the steps over knots, which are a few roundings long and are not cut; 0 without knots.

    It is that length times the jump of the coefficients, what the rounding of the knot's place does. Above LOUDEST_NOISE it is none.
    """
    over = errors[across_knots(nodes)].max(initial=0.0)
    return float(over) if over <= LOUDEST_NOISE else 0.0


def _overlooked(before: Shooting, after: Shooting, sigma: complex) -> NDArray[np.float64]:
    """Knots in the steps whose errors did not fall with the order of the method when they were cut: narrow features, say.

    The steps with the largest errors are looked at, in a problem that may have knots. Every coefficient is raised by twice its largest size
    on the mesh: what rounds as that size does, as 1 − tanh² where it vanishes, is noise and no row of knots, and nothing cancels.
    """
    problem, nodes = after.problem, after.sampled.nodes
    first = np.flatnonzero(np.isin(nodes[:-1], before.sampled.nodes[:-1]))
    old = before.propagated(sigma, False).errors
    if len(first) != len(old) or KNOTS.of(problem) is None or nodes.imag.any():
        return np.zeros(0)
    parts = np.diff(np.append(first, after.steps))
    errors = after.propagated(sigma, False).errors
    expected = np.repeat(np.where((parts > 1) & (old < RESOLVED_ERROR), old / parts.astype(float) ** KNOT_ORDER, np.inf), parts)
    suspect = np.flatnonzero((errors > expected) & (errors > after.tolerance))
    worst = suspect[np.argsort(-errors[suspect])[:CLOSER_LOOKS]]

    def coefficients(t: NDArray[np.float64]) -> ComplexArray:
        at = problem.pencil(t.astype(np.complex128))
        return np.concatenate([M.reshape(len(t), -1) for M in (*at.C, *at.D)], axis=1)

    if not len(worst):
        return np.zeros(0)
    largest = 2.0 * np.abs(coefficients(nodes.real)).max(axis=0)

    def raised(t: NDArray[np.float64]) -> ComplexArray:
        return np.asarray(coefficients(t) + largest)

    steps = [sorted(nodes[i : i + 2].real.tolist()) for i in worst.tolist()]
    return np.concatenate([np.zeros(0), *(find_knots(raised, low, high, np.zeros(0)) for low, high in steps)])


def _with_knots(nodes: ComplexArray, knots: NDArray[np.float64]) -> ComplexArray:
    """Real nodes with two on either side of each knot."""
    real = nodes.real
    span, largest = abs(float(real[-1] - real[0])), float(np.abs(real).max())
    return with_pairs(real, np.array([pair(knot, span, largest) for knot in knots.tolist()])).astype(np.complex128)


def _trouble(shooting: Shooting, errors: NDArray[np.float64], sigma: complex) -> str:
    """What stands in the way where the local errors are largest: C is singular there, or the solution is too steep."""
    bad = np.flatnonzero(~np.isfinite(errors))
    worst = int(bad[0]) if len(bad) else int(errors.argmax())
    z = shooting.sampled.nodes[worst : worst + 2].mean()
    where = f"{z.real:.6g}" if z.imag == 0.0 else f"{z:.6g}"
    if _nearly_singular(shooting, np.array([z]), sigma)[0]:
        return f"C is singular next to z = {where}"
    return f"solutions or coefficients vary too fast next to z = {where}"


def _nearly_singular(shooting: Shooting, z: ComplexArray, sigma: complex) -> NDArray[np.bool_]:
    """Where of the points z (m,) C(σ) is singular to SMALL_DETERMINANT."""
    singular = np.linalg.svd(polynomial.value(shooting.problem.pencil(z).C, sigma), compute_uv=False)
    return np.asarray(singular[:, -1] < SMALL_DETERMINANT * singular[:, 0])
