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
FALSE_POSITIONS = 100  # chosen: steps of the search for a place, more than are ever needed
CLOSED_PLACE = 4e-16  # derived: two units in the last place of an end
OWN_PIECE = 1.0 + 1e-9  # chosen: part of a radius: the end of a piece, where the next one begins, is its own to rounding
SAME_SHEET = 1e-6  # chosen: a continued solution that agrees so well with a piece is the solution of that piece


def terms_for(tolerance: float) -> int:
    """The number of terms that costs least for a tolerance: one more than Jorba & Zou's order 1 − ½ ln ε."""
    return math.ceil(1.0 - 0.5 * math.log(tolerance)) + 1


# Functions that are called from one place are inlined there: numba would compile one by itself, and with its caller once more. Assignments
# to slices would take seconds to compile.


@njit(cache=True, error_model="numpy", inline="always")
def expand(program, parameters, values, y, sizes, terms):  # type: ignore[no-untyped-def]
    """Fill y (n, N), so many Taylor coefficients of the solution from y[:, 0] on, and sizes (n,). values (r, N) is memory for the nodes.

    Returns the function that stops, at the centre.
    """
    result = program[6]
    n = y.shape[0]
    for m in range(terms):
        carry_out(program, parameters, y, m, values)
        if m + 1 < terms:
            for c in range(n):
                y[c, m + 1] = values[result[c], m] / (m + 1)
    for c in range(n):
        sizes[c] = max(abs(y[c, 0]), abs(values[result[n + c], 0]))
    return values[result[2 * n], 0].real


@njit(cache=True, error_model="numpy", inline="always")
def radius(y, sizes, tolerance):  # type: ignore[no-untyped-def]
    """The distance at which the last two terms of y (n, N) reach the tolerance; NaN where they are no numbers."""
    n, terms = y.shape
    least = np.inf
    for c in range(n):
        for m in range(terms - 2, terms):
            term = abs(y[c, m])
            if not term < np.inf:
                least = np.nan
            elif term > 0.0 and least == least:
                least = min(least, (tolerance * sizes[c] / term) ** (1.0 / m))
    return least


@njit(cache=True, error_model="numpy", inline="always")
def value(pieces, k, t, out, place):  # type: ignore[no-untyped-def]
    """out[place] (n,) = Σ y[:, m] t^m, y = pieces[k]."""
    _, n, terms = pieces.shape
    for c in range(n):
        total = pieces[k, c, terms - 1] + 0 * t
        for m in range(terms - 2, -1, -1):
            total = total * t + pieces[k, c, m]
        out[place, c] = total


LOOK, SEEK, NODE, LAST = range(4)  # exact: purposes for which `integrate` expands the solution


@njit(cache=True, error_model="numpy")
def integrate(program, parameters, start, tolerance, limits, nodes, pieces, radii):  # type: ignore[no-untyped-def]
    """Pieces from z = 0 downwards until the function that stops changes sign.

    limits (2, n) are what the components of a solution must stay above and below. Fills nodes (m,), pieces (m, n, N) and radii (m,), the
    place of the change of sign with the piece around it last. Returns their number, and whether there was such a change.

    The function is looked at in LOOKS places of a piece, for which one term of the solution there is enough. Where it has changed its sign
    since the last look, its zero is sought by false position with halved weights (Illinois).
    """
    n, terms = pieces.shape[1:]
    values, sizes, point, local = np.empty((len(program[0]), terms)), np.empty(n), np.empty((1, n)), np.empty((n, terms))
    for c in range(n):
        point[0, c] = start[c]
    nodes[0] = 0.0
    why, k, tries = NODE, 0, 0
    first, sign, at_node = 0.0, 0.0, 0.0  # the first radius; the function at the first node and at the last one
    h, t, near, f_near, far, f_far = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0  # a piece reaches to −h, a look to −t; a zero in a bracket, f at its ends
    while True:
        for c in range(n):
            local[c, 0] = point[0, c]
        stop = expand(program, parameters, values, local, sizes, terms if why >= NODE else 1)
        if why >= NODE:
            for c in range(n):
                for m in range(terms):
                    pieces[k, c, m] = local[c, m]
            radii[k] = radius(local, sizes, tolerance)
            if why == LAST:
                return k + 1, True
            if k == 0:
                first, sign = radii[0], stop
            if k == len(nodes) - 1 or not radii[k] > LEAST_RADIUS * first:
                return k + 1, False
            at_node = stop
            h, near, f_near = radii[k], 0.0, at_node
        else:
            for c in range(n):
                if not limits[0, c] < point[0, c] < limits[1, c]:
                    stop = np.nan
            if why == SEEK:
                if (stop > 0.0) != (f_far > 0.0):
                    near, f_near = far, f_far
                else:
                    f_near *= 0.5
                far, f_far, tries = t, stop, tries + 1
            elif np.isnan(stop):  # the solution passed a limit: stop as near to it as a shorter piece comes
                h, near, f_near = 0.5 * t, 0.0, at_node
                if not h > LEAST_RADIUS * max(first, radii[k]):
                    return k + 1, False
            elif (stop > 0.0) != (sign > 0.0):
                why, far, f_far, tries = SEEK, t, stop, 0
            else:
                near, f_near = t, stop
        if why == SEEK:
            if f_far == 0.0 or abs(far - near) <= CLOSED_PLACE * abs(far) or tries == FALSE_POSITIONS:
                why, t = LAST, far
            else:
                t = far - f_far * (far - near) / (f_far - f_near)
        elif near < h:
            why, t = LOOK, near + h / LOOKS if near + 1.5 * h / LOOKS < h else h
        else:
            why, t = NODE, h
        value(pieces, k, -t, point, 0)
        if why >= NODE:
            k += 1
            nodes[k] = nodes[k - 1] - t


@njit(cache=True, error_model="numpy")
def from_pieces(nodes, pieces, radii, places, z, out, known):  # type: ignore[no-untyped-def]
    """out (p, n), the solution at points z (p,) from the pieces, and known (p,), whether a piece has the point in its disc.

    nodes (m,) fall, pieces (m, n, N), radii (m,); places (p,) are those of the nodes next above Re z. A real point has the piece of
    this node, a complex one that of this or of the next, in whose disc it lies deeper.
    """
    n, terms = pieces.shape[1:]
    for p in range(len(z)):
        best = places[p]
        if z[p].imag == 0.0:
            t = z[p].real - nodes[best]
            known[p] = abs(t) <= OWN_PIECE * radii[best]
            if known[p]:
                for c in range(n):
                    total = pieces[best, c, terms - 1]
                    for m in range(terms - 2, -1, -1):
                        total = total * t + pieces[best, c, m]
                    out[p, c] = total
            continue
        depth = abs(z[p] - nodes[best]) / radii[best]
        if best + 1 < len(nodes) and abs(z[p] - nodes[best + 1]) / radii[best + 1] < depth:
            best += 1
            depth = abs(z[p] - nodes[best]) / radii[best]
        known[p] = depth <= 1.0
        if known[p]:
            value(pieces, best, z[p] - nodes[best], out, p)


@njit(cache=True, error_model="numpy", inline="always")
def on_one_branch(program, values, t):  # type: ignore[no-untyped-def]
    """Whether powers continued to a place t of a piece are the principal ones still, which the formulas take there."""
    operation, left, right, _, _, _, _ = program
    terms, same = values.shape[1], True
    for k in range(len(operation)):
        if operation[k] == POWER:
            base, power = values[left[k], terms - 1], values[k, terms - 1]
            for m in range(terms - 2, -1, -1):
                base, power = base * t + values[left[k], m], power * t + values[k, m]
            same = same and abs(power - base ** values[right[k], 0]) <= SAME_SHEET * abs(power)
    return same


@njit(cache=True, error_model="numpy")
def along_path(program, parameters, radii, tolerance, terms, beginning, start, z, known, out):  # type: ignore[no-untyped-def]
    """out (p, n): the solution at points z (p,), followed one after the other; what is known (p,) of it stands there already.

    Where it is not known the solution is continued by pieces of its own, of so many terms, from the point before, and at the first one from
    the solution start (n,) at a beginning; until what is known agrees with it again. radii (p,) are those of pieces of the solution
    near by: shorter ones stand at a singularity. Returns how many points were reached.
    """
    n = out.shape[1]
    values, sizes, point = np.empty((len(program[0]), terms), np.complex128), np.empty(n), np.empty((1, n), np.complex128)
    pieces = np.empty((1, n, terms), np.complex128)
    local = pieces[0]
    apart, centre, reach, first = False, beginning, 0.0, 0.0
    for p in range(len(z)):
        if known[p] and not apart:
            continue
        begins, tries = not apart, 0
        if begins:
            apart, first, centre = True, radii[p], z[p - 1] if p > 0 else beginning
            for c in range(n):
                point[0, c] = out[p - 1, c] if p > 0 else start[c]
        while True:
            if not begins:
                t = z[p] - centre
                distance = abs(t)
                arrives = distance <= reach
                if not arrives:
                    tries += 1
                    if not reach > LEAST_RADIUS * first or tries > MOST_STEPS:
                        return p
                    t *= reach / distance
                if not on_one_branch(program, values, t):
                    return p
                value(pieces, 0, t, point, 0)
                if arrives:
                    break
                centre += t
            for c in range(n):
                local[c, 0] = point[0, c]
            expand(program, parameters, values, local, sizes, terms)
            reach, begins = radius(local, sizes, tolerance), False
        difference = np.inf
        if known[p]:
            difference = 0.0
            for c in range(n):
                difference = max(difference, abs(out[p, c] - point[0, c]) / sizes[c])
        if difference <= SAME_SHEET:
            apart = False
        else:
            for c in range(n):
                out[p, c] = point[0, c]
    return len(z)
