"""Solutions of y′ = f(y) as Taylor polynomials, each good to the tolerance in a disc of the complex plane around its centre.

f is a recorded program (core/straight_line.py). Its results are the n slopes, then n sizes, and last a function of y that says where
to stop. A component's error is measured against the larger of its own and the given size. The radius of a piece is the one at
which the last two terms are as large as the tolerance (À. Jorba & M. Zou, Experimental Mathematics 14 (2005) 99, 3.2).
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from shootstab.core.straight_line import POWER
from shootstab.kernels.recorded_programs import carry_out

LEAST_RADIUS = 1e-13  # chosen: a piece so much shorter than the first one stands at a singularity
MOST_STEPS = 4000  # chosen: pieces from one point to the next; a path that needs more runs into a singularity
LOOKS = 4  # chosen: parts of a piece at whose ends the function that stops is looked at
FALSE_POSITIONS, CLOSED_PLACE = (
    100,
    4e-16,
)  # chosen, more than are ever needed, and derived: two units in the last place of an end
OWN_PIECE = 1.0 + 1e-9  # chosen: of a radius: the end of a piece, where the next one begins, is its own to rounding
SAME_SHEET = 1e-6  # chosen: a continued solution that agrees so well with a piece is the one that the piece is of


def terms_for(tolerance: float) -> int:
    """How many terms cost least for a tolerance: one more than Jorba & Zou's order 1 − ½ ln ε."""
    return math.ceil(1.0 - 0.5 * math.log(tolerance)) + 1


@njit(cache=True, error_model="numpy")
def expand(program, parameters, values, y, sizes):  # type: ignore[no-untyped-def]
    """Fill y (n, N), the Taylor coefficients of the solution from y[:, 0] on, and sizes (n,). values (r, N) is memory for the nodes.

    Returns the function that stops, at the centre.
    """
    result = program[6]
    n, terms = y.shape
    for m in range(terms):
        carry_out(program, parameters, y, m, values)
        if m + 1 < terms:
            for c in range(n):
                y[c, m + 1] = values[result[c], m] / (m + 1)
    for c in range(n):
        sizes[c] = max(abs(y[c, 0]), abs(values[result[n + c], 0]))
    return values[result[2 * n], 0].real


@njit(cache=True, error_model="numpy")
def radius(y, sizes, tolerance):  # type: ignore[no-untyped-def]
    """Where the last two terms of y (n, N) reach the tolerance; NaN where they are no numbers."""
    n, terms = y.shape
    least = np.inf
    for c in range(n):
        for m in range(terms - 2, terms):
            term = abs(y[c, m])
            if not term < np.inf:
                return np.nan
            if term > 0.0:
                least = min(least, (tolerance * sizes[c] / term) ** (1.0 / m))
    return least


@njit(cache=True, error_model="numpy")
def value(y, t, out):  # type: ignore[no-untyped-def]
    """out (n,) = Σ y[:, m] t^m."""
    n, terms = y.shape
    for c in range(n):
        total = y[c, terms - 1] + 0 * t
        for m in range(terms - 2, -1, -1):
            total = total * t + y[c, m]
        out[c] = total


@njit(cache=True, error_model="numpy")
def _stop(program, parameters, values, piece, t, limits, point, sizes):  # type: ignore[no-untyped-def]
    """The function that stops at a place t of a piece; NaN where a component is beyond its limits. point (n, 1) is the value there."""
    value(piece, t, point[:, 0])
    for c in range(len(point)):
        if not limits[0, c] < point[c, 0] < limits[1, c]:
            return np.nan
    return expand(program, parameters, values, point, sizes)


@njit(cache=True, error_model="numpy")
def _place(program, parameters, values, piece, near, far, limits, point, sizes):  # type: ignore[no-untyped-def]
    """Where the function that stops vanishes between t = −near and −far, by false position with halved weights (Illinois)."""
    low, high = near, far
    f_low = _stop(program, parameters, values, piece, -low, limits, point, sizes)
    f_high = _stop(program, parameters, values, piece, -high, limits, point, sizes)
    for _ in range(FALSE_POSITIONS):
        if f_high == 0.0 or abs(high - low) <= CLOSED_PLACE * abs(high):
            break
        t = high - f_high * (high - low) / (f_high - f_low)
        f = _stop(program, parameters, values, piece, -t, limits, point, sizes)
        if (f > 0.0) != (f_high > 0.0):
            low, f_low = high, f_high
        else:
            f_low *= 0.5
        high, f_high = t, f
    return high


@njit(cache=True, error_model="numpy")
def integrate(program, parameters, start, tolerance, longest, limits, nodes, pieces, radii):  # type: ignore[no-untyped-def]
    """Pieces from z = 0 downwards, none longer than `longest`, until the function that stops changes sign.

    limits (2, n) are what the components of a solution must stay above and below. Fills nodes (m,), pieces (m, n, N) and radii (m,), the
    place of the change of sign with the piece around it last. Returns their number, and whether there was such a change.
    """
    n, terms = pieces.shape[1:]
    values, sizes, point = np.empty((len(program[0]), terms)), np.empty(n), np.empty((n, 1))
    pieces[0, :, 0] = start
    nodes[0] = 0.0
    sign, first = 0.0, 0.0
    for k in range(len(nodes)):
        stop = expand(program, parameters, values, pieces[k], sizes)
        radii[k] = radius(pieces[k], sizes, tolerance)
        if k == 0:
            sign, first = stop, radii[0]
        if k == len(nodes) - 1 or not radii[k] > LEAST_RADIUS * first:
            return k + 1, False
        h, near = min(radii[k], longest), 0.0
        while near < h:
            far = near + h / LOOKS if near + 1.5 * h / LOOKS < h else h
            stop = _stop(program, parameters, values, pieces[k], -far, limits, point, sizes)
            if np.isnan(stop):  # beyond a limit: as near to it as a shorter piece comes
                h, near = 0.5 * far, 0.0
                if not h > LEAST_RADIUS * first:
                    return k + 1, False
            elif (stop > 0.0) != (sign > 0.0):
                h = _place(program, parameters, values, pieces[k], near, far, limits, point, sizes)
                nodes[k + 1] = nodes[k] - h
                value(pieces[k], -h, pieces[k + 1, :, 0])
                expand(program, parameters, values, pieces[k + 1], sizes)
                radii[k + 1] = radius(pieces[k + 1], sizes, tolerance)
                return k + 2, True
            else:
                near = far
        nodes[k + 1] = nodes[k] - h
        value(pieces[k], -h, pieces[k + 1, :, 0])
    return len(nodes), False


@njit(cache=True, error_model="numpy")
def _from_piece(nodes, pieces, radii, place, z, out):  # type: ignore[no-untyped-def]
    """The solution at z from a piece, True; or False where no piece has z in its disc.

    place is that of the node next above Re z. A real point has the piece of this node, a complex one that of this or of the next, in whose
    disc it lies deeper.
    """
    if z.imag == 0.0:
        t = z.real - nodes[place]
        if not abs(t) <= OWN_PIECE * radii[place]:
            return False
        n, terms = pieces.shape[1:]
        for c in range(n):
            total = pieces[place, c, terms - 1]
            for m in range(terms - 2, -1, -1):
                total = total * t + pieces[place, c, m]
            out[c] = total
        return True
    best, depth = place, abs(z - nodes[place]) / radii[place]
    if place + 1 < len(nodes) and abs(z - nodes[place + 1]) / radii[place + 1] < depth:
        best, depth = place + 1, abs(z - nodes[place + 1]) / radii[place + 1]
    if not depth <= 1.0:
        return False
    value(pieces[best], z - nodes[best], out)
    return True


@njit(cache=True, error_model="numpy")
def _on_one_branch(program, values, t):  # type: ignore[no-untyped-def]
    """Whether powers continued to a place t of a piece are the principal ones still, which the formulas take there."""
    operation, left, right, _, _, _, _ = program
    terms = values.shape[1]
    for k in range(len(operation)):
        if operation[k] == POWER:
            base, power = values[left[k], terms - 1], values[k, terms - 1]
            for m in range(terms - 2, -1, -1):
                base, power = base * t + values[left[k], m], power * t + values[k, m]
            if not abs(power - base ** values[right[k], 0]) <= SAME_SHEET * abs(power):
                return False
    return True


@njit(cache=True, error_model="numpy")
def along_path(program, parameters, nodes, pieces, radii, places, tolerance, z, out):  # type: ignore[no-untyped-def]
    """out (p, n): the solution at points z (p,), followed one after the other, from the piece next to the first one on.

    nodes (m,) fall, pieces (m, n, N), radii (m,); places (p,) are those of the nodes next above. Outside the discs of the
    pieces the solution is continued by pieces of its own along the path. Returns how many points were reached.
    """
    n, terms = pieces.shape[1:]
    values, sizes = np.empty((len(program[0]), terms), np.complex128), np.empty(n)
    local, known, numbers = np.empty((n, terms), np.complex128), np.empty(n, np.complex128), parameters.astype(np.complex128)
    apart, centre, reach, first = False, 0j, 0.0, 0.0
    for p in range(len(z)):
        within = _from_piece(nodes, pieces, radii, places[p], z[p], known)
        if not apart and within:
            out[p] = known
            continue
        if not apart:
            if p > 0:
                centre, local[:, 0] = z[p - 1], out[p - 1]
            else:
                centre = complex(max(z[p].real, nodes[places[p]] - radii[places[p]]))
                _from_piece(nodes, pieces, radii, places[p], centre, local[:, 0])
            expand(program, numbers, values, local, sizes)
            apart, reach, first = True, radius(local, sizes, tolerance), radii[places[p]]
        tries = 0
        while not abs(z[p] - centre) <= reach:
            tries += 1
            if not reach > LEAST_RADIUS * first or tries > MOST_STEPS:
                return p
            t = (z[p] - centre) * (reach / abs(z[p] - centre))
            if not _on_one_branch(program, values, t):
                return p
            value(local, t, local[:, 0])
            centre += t
            expand(program, numbers, values, local, sizes)
            reach = radius(local, sizes, tolerance)
        value(local, z[p] - centre, out[p])
        if not _on_one_branch(program, values, z[p] - centre):
            return p
        if within:
            difference = 0.0
            for c in range(n):
                difference = max(difference, abs(known[c] - out[p, c]) / sizes[c])
            if difference <= SAME_SHEET:
                out[p], apart = known, False
    return len(z)


@njit(cache=True, error_model="numpy")
def at_each(program, parameters, nodes, pieces, radii, places, tolerance, z, out):  # type: ignore[no-untyped-def]
    """The same for points each of which is reached from the real axis by a path of its own. Returns how many were reached."""
    for p in range(len(z)):
        one = slice(p, p + 1)
        known = _from_piece(nodes, pieces, radii, places[p], z[p], out[p])
        if not known and along_path(program, parameters, nodes, pieces, radii, places[one], tolerance, z[one], out[one]) < 1:
            return p
    return len(z)
