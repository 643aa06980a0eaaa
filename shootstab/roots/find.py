"""All zeros of D inside a rectangle, without a guess: count, divide, polish."""

from __future__ import annotations

from shootstab.discriminants.protocol import Discriminant
from shootstab.roots.iterations import newton
from shootstab.roots.winding import Winding, wind
from shootstab.vocabulary.errors import ConvergenceError
from shootstab.vocabulary.regions import Rectangle

SMALLEST = 1e-9  # of the first rectangle's diagonal: zeros closer than this are one multiple zero


def find(discriminant: Discriminant, region: Rectangle) -> list[complex]:
    """The zeros inside, each as often as its multiplicity, polished by Newton.

    Raises ConvergenceError when a zero lies on the boundary of the region.
    """
    return _find(discriminant, region, wind(discriminant, region), SMALLEST * _diagonal(region))


def _find(discriminant: Discriminant, region: Rectangle, winding: Winding, smallest: float) -> list[complex]:
    if winding.count == 0:
        return []
    if winding.count == 1:
        root = newton(discriminant, winding.centre + winding.moment, 1e-12)
        if root.converged and _within(region, root.sigma, 2 * root.step):
            return [root.sigma]
    if _diagonal(region) < smallest:
        return [winding.centre + winding.moment / winding.count] * winding.count
    for cut in (0.5, 0.47, 0.55, 0.41, 0.62):
        halves = _halves(region, cut)
        try:
            windings = [wind(discriminant, half) for half in halves]
        except ConvergenceError:
            continue  # a zero on the cut: cut elsewhere
        if sum(w.count for w in windings) != winding.count:
            raise ConvergenceError(f"counts do not add up in {region}: {winding.count} against {[w.count for w in windings]}")
        return [z for half, w in zip(halves, windings, strict=True) for z in _find(discriminant, half, w, smallest)]
    raise ConvergenceError(f"no way found to divide {region} without a zero on the cut")


def _within(region: Rectangle, sigma: complex, slack: float) -> bool:
    a, b = complex(region.lower_left), complex(region.upper_right)
    return a.real - slack < sigma.real < b.real + slack and a.imag - slack < sigma.imag < b.imag + slack


def _halves(region: Rectangle, cut: float) -> tuple[Rectangle, Rectangle]:
    a, b = complex(region.lower_left), complex(region.upper_right)
    if b.real - a.real > b.imag - a.imag:
        x = a.real + cut * (b.real - a.real)
        return Rectangle(a, complex(x, b.imag)), Rectangle(complex(x, a.imag), b)
    y = a.imag + cut * (b.imag - a.imag)
    return Rectangle(a, complex(b.real, y)), Rectangle(complex(a.real, y), b)


def _diagonal(region: Rectangle) -> float:
    return abs(complex(region.upper_right) - complex(region.lower_left))
