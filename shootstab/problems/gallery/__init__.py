"""Solved problems with their published digits."""
