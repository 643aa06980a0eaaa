"""Checkers of certificates: one file a problem, the equations typed again, on mpmath's intervals or on integers alone."""

# exact: the file of each checker, by the name that stands in its certificates
CHECKERS = {"plane Poiseuille": "plane_poiseuille", "granular chute": "granular_chute", "polynomial pencil": "polynomial_pencil"}
