"""D(σ) of a problem, every σ on the mesh that its cells give it: a function of σ, whatever was asked before."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Sequence

from shootstab.core.discriminant import Value
from shootstab.core.errors import ConvergenceError, anew
from shootstab.core.regions import Disc
from shootstab.core.scaled import Scaled
from shootstab.discriminants.cells import Cell
from shootstab.discriminants.deformed_path import DeformedPath
from shootstab.discriminants.meshing import MOST_BYTES, TooLong, cut_for, made_for, too_long
from shootstab.discriminants.method import Meshes, Propagator
from shootstab.discriminants.product import Product
from shootstab.discriminants.sampled_system import SampledSystem, sample_system
from shootstab.discriminants.shooting import Shooting
from shootstab.discriminants.subsystems import decouple
from shootstab.problems.protocol import ComplexArray, Problem

CELL_LEVELS = 2  # chosen: sizes of cells: what a cell of 8 % in |σ| and 4.4° does not serve has a mesh of its own
CIRCLE_POINTS = 4  # chosen: points of a circle at which its mesh must hold: those at which a count samples it first
MOST_MESHES = 64  # chosen: kept at a time; those that were asked for longest ago are made again if they are needed
MOST_BYTES_KEPT = 2 * MOST_BYTES  # chosen: memory of the systems on all of them, two of the longest meshes that there may be
ON_THE_WAY = CELL_LEVELS + 1  # derived: meshes from the largest cell of a σ to its own, kept whatever they take: each value asks for them


MeshKey = Cell | None | complex  # the key of a mesh: the cell that it serves, what a path is meant for, or a σ of its own


class SubsystemMeshes:
    """The meshes of one subsystem, or of the whole if it does not fall into several."""

    def __init__(
        self,
        problem: Problem,
        whole: Problem,
        propagator: Propagator,
        path: DeformedPath | None,
        centre: complex | None,
        begin: dict[Cell | None, ComplexArray],
        most_bytes: int,
    ) -> None:
        self.problem, self._whole, self.propagator, self.path, self._centre, self._begin = problem, whole, propagator, path, centre, begin
        self._kept: OrderedDict[MeshKey, Shooting | ConvergenceError] = OrderedDict()
        self._most_bytes, self._spent = most_bytes, 0

    def at(self, sigma: complex, tangent: bool, most: int | None = None) -> Shooting:
        """D on the mesh of the largest cell that serves σ, or on one made for σ. Raises ConvergenceError where none can be made, or none
        of so many steps at most."""
        coarser: Shooting | None = None
        for key in (*self._cells(sigma), sigma):
            made = self._made(key, coarser, most)
            if isinstance(made, Shooting) and made is not coarser:
                if most is not None and made.steps > most:
                    raise too_long(sigma, most)
                if key is sigma or _serves(made, sigma, tangent):
                    return made
                coarser = made
        if isinstance(made, ConvergenceError):
            raise anew(made)
        return made

    def around(self, disc: Disc) -> Shooting:
        """D on the mesh that serves the middle of a disc, cut further where a point of its rim asks for it."""
        rim = [disc.boundary(k / CIRCLE_POINTS) for k in range(CIRCLE_POINTS)]
        return cut_for(self.at(disc.centre, True), rim)

    @property
    def evaluations(self) -> int:
        """How often D was computed on the meshes that are kept or were."""
        return self._spent + sum(made.evaluations for made in self.shootings)

    @property
    def bytes_kept(self) -> int:
        """The memory of the systems on the meshes that are kept by now."""
        return sum(made.steps * made.sampled.bytes_of_a_step for made in self.shootings)

    @property
    def nodes(self) -> dict[Cell | None, ComplexArray]:
        """The nodes (N + 1,) of the cells that are known by now, those with which cells that were not needed would begin among them."""
        made = {key: made.sampled.nodes for key, made in self._kept.items() if isinstance(made, Shooting) and not isinstance(key, complex)}
        return self._begin | made

    @property
    def shootings(self) -> list[Shooting]:
        """D on the meshes that are kept by now; one that serves several cells is one."""
        return list({id(made): made for made in self._kept.values() if isinstance(made, Shooting)}.values())

    def _cells(self, sigma: complex) -> list[Cell | None]:
        """The cells around σ from the largest to the smallest; along a path, what it is meant for stands in place of the largest ones."""
        cells = [Cell.of(sigma, CELL_LEVELS - 1)]
        while cells[-1].level > 0:
            cells.append(cells[-1].larger)
        return [*reversed(cells)] if self._centre is None else [None, *reversed(cells[: CELL_LEVELS // 2])]

    def _made(self, key: MeshKey, coarser: Shooting | None, most: int | None = None) -> Shooting | ConvergenceError:
        """The mesh of a cell, cut from that of the cell that it lies in; what stood in the way where none can be made for the cell's σ.

        Raises TooLong, and keeps nothing, where it would have more steps than most.
        """
        if key not in self._kept:
            self._kept[key] = self._make(key, coarser, most)
            while len(self._kept) > MOST_MESHES or (len(self._kept) > ON_THE_WAY and self.bytes_kept > self._most_bytes):
                before = self.evaluations
                self._kept.popitem(last=False)
                self._spent += before - self.evaluations
        self._kept.move_to_end(key)
        return self._kept[key]

    def _make(self, key: MeshKey, coarser: Shooting | None, most: int | None) -> Shooting | ConvergenceError:
        smallest: complex | None = None
        if isinstance(key, complex):
            sigma: complex | None = key
        else:
            sigma, smallest = (self._centre, None) if key is None else (key.anchor, key.smallest)
            if coarser is not None and all(_serves(coarser, end, False) for end in (sigma, smallest) if end is not None):
                return coarser
        assert sigma is not None
        begin: Shooting | SampledSystem | None = coarser
        if begin is None and not isinstance(key, complex) and key in self._begin:
            begin = sample_system(self.problem, self._begin[key])
        try:
            return made_for(self.problem, self.propagator, self.path, sigma, begin, smallest, most, self._whole)
        except TooLong:
            raise
        except ConvergenceError as error:
            return anew(error)


def _serves(made: Shooting, sigma: complex, tangent: bool) -> bool:
    """Whether a mesh serves σ; one whose far end knows no frame for σ does not."""
    try:
        return made.serves(sigma, tangent)
    except ConvergenceError:
        return False


class Adaptive:
    """D(σ) = factor · Π D_i(σ) over the subsystems, each on the mesh that σ's cells give it.

    The meshes that are kept change how long an answer takes, and no answer.
    """

    def __init__(
        self,
        problem: Problem,
        propagator: Propagator,
        path: DeformedPath | None = None,
        centre: complex | None = None,
        begin: Meshes | None = None,
    ) -> None:
        self.problem, self.propagator, self.path = problem, propagator, path
        self._decoupling = decouple(problem)
        subsystems: Sequence[Problem] = (problem,) if self._decoupling is None else self._decoupling.members
        most_bytes = MOST_BYTES_KEPT // len(subsystems)
        self._members = tuple(
            SubsystemMeshes(subsystem, problem, propagator, path, centre, _of_member(begin, i, len(subsystems)), most_bytes)
            for i, subsystem in enumerate(subsystems)
        )
        self._products: OrderedDict[tuple[int, ...], Product] = OrderedDict()

    def __repr__(self) -> str:
        path = "" if self.path is None else f", {self.path}"
        return f"D(σ) of {self.problem!r} by {self.propagator!r}{path}"

    def at(self, sigma: complex, tangent: bool = True, most: int | None = None) -> Shooting | Product:
        """D on the mesh that serves σ. Raises ConvergenceError where none is found, or none of so many steps at most."""
        sigma = complex(sigma)
        return self._together(tuple(member.at(sigma, tangent, most) for member in self._members))

    def around(self, centre: complex, radius: float) -> Shooting | Product:
        """D on one mesh that serves the circle. Raises ConvergenceError where none is found."""
        disc = Disc(complex(centre), radius)
        return self._together(tuple(member.around(disc) for member in self._members))

    def __call__(self, sigma: complex) -> Scaled:
        return self.at(sigma, False)(sigma)

    def with_derivative(self, sigma: complex) -> Value:
        return self.at(sigma).with_derivative(sigma)

    @property
    def evaluations(self) -> int:
        """How often D was computed, on all meshes and for them; of the subsystem that needed it most often."""
        return max(member.evaluations for member in self._members)

    @property
    def bytes_kept(self) -> int:
        """The memory of the systems on the meshes that are kept by now, of all subsystems."""
        return sum(member.bytes_kept for member in self._members)

    @property
    def meshes(self) -> Meshes:
        """The nodes (N + 1,) of the cells that are known by now, one array for every subsystem."""
        nodes = [member.nodes for member in self._members]
        return {cell: tuple(n[cell] for n in nodes) for cell in nodes[0] if all(cell in n for n in nodes)}

    def _together(self, members: tuple[Shooting, ...]) -> Shooting | Product:
        """The members as one discriminant, the same object for the same meshes."""
        if self._decoupling is None:
            return members[0]
        key = tuple(map(id, members))
        if key not in self._products:
            kept = {id(shooting) for member in self._members for shooting in member.shootings}
            for other in [other for other in self._products if not kept.issuperset(other)]:
                del self._products[other]
            self._products[key] = Product(self._decoupling, members)
            if len(self._products) > MOST_MESHES:
                self._products.popitem(last=False)
        return self._products[key]


def _of_member(begin: Meshes | None, place: int, count: int) -> dict[Cell | None, ComplexArray]:
    """The meshes of one subsystem, of a problem that falls into as many."""
    return {cell: nodes[place] for cell, nodes in (begin or {}).items() if len(nodes) == count}


def adaptive(
    method: Propagator, problem: Problem, path: DeformedPath | None = None, centre: complex | None = None, begin: Meshes | None = None
) -> Adaptive:
    """D(σ) of the problem, along the real axis or along a path meant for σ = centre; begin are meshes (N + 1,) of another problem.

    It is the `on` of every method that is its own propagator. Raises InputError where D is asked for and the problem is wrong,
    ConvergenceError where no mesh is found.
    """
    return Adaptive(problem, method, path, centre, begin)
