"""What may be asked for, and what is meant where nothing is: one number each for the function that checks it, the option that offers it and
the sentence that refuses."""

from __future__ import annotations

RTOL = 1e-10  # chosen: the relative accuracy of one mode
FINDING_RTOL = 1e-8  # chosen: the relative accuracy of the modes of a region, of which there may be many
LEAST_MODE_RTOL = 1e-14  # derived: the smallest relative accuracy, some fifty roundings of a double
LARGEST_TOLERANCE = 0.1  # chosen: the largest relative accuracy on the command line, one digit
DOUBLE_DIGITS = 12  # derived: 16 of a double less what conditioning and error bound take; more are computed with many digits
MOST_DIGITS = 10_000  # chosen: digits of a mode, which take days
MOST_MODE_DIGITS = 1000  # chosen: digits of an eigenfunction, which take an hour
VERDICT_DIGITS = 6  # defined by the contract: digits that an eigenvalue must have to be confirmed
BASELINE_DIGITS = 8  # chosen: digits of a baseline in which codes are compared
PROOF_DIGITS = 12  # chosen: digits of the disc of a theorem on one mode
MOST_PROOF_DIGITS = 1000  # chosen: the most of them, which take hours
SWEEP_DIGITS = 8  # chosen: digits of σ at a point of a sweep
MOST_SWEEP_DIGITS = DOUBLE_DIGITS - 1  # chosen: one fewer than of a mode alone, as bounds are carried over from point to point
COUNT_EVERY = 12  # chosen: modes are counted at one in so many points of a line of a sweep
MOST_EVERY = 1000  # chosen: the largest such stride, longer than a line
MOST_WORKERS = 1024  # chosen: processes of a sweep on one machine
GUESS_RADIUS = 0.5  # chosen: how far a mode may lie from the guess that means it, in the larger of the two
GROWTH_FLOOR = 1e-8  # chosen: the Re σ, in the units of the problem, above which a mode is taken to grow
LARGEST_FLOOR = 1e-2  # chosen: the floor of a count stays below this radius, from which on a bound of growing modes is looked for
LEAST_TRUNCATION, MOST_TRUNCATION = 10, 1000  # chosen: orders of a pseudospectral reference; with 1000, QZ takes an hour
MODE_HEIGHTS = 401  # chosen: heights in a picture or a file of a mode; a line through so many points looks smooth
MOST_HEIGHTS = 100_000  # chosen: heights of a table, some 10 MB of text
LARGEST_GUESS = 1e100  # chosen: |σ| up to which squares are doubles, and those of ten thousand times as large ones
