"""D(σ) to any number of digits: Taylor series throughout, in python-flint or in mpmath."""
