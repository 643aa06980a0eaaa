"""Checkers of certificates: one file a problem, the equations typed again, on mpmath's intervals alone."""
