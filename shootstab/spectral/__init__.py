"""The pseudospectral reference: matrix spectra from Chebyshev collocation, independent of the shooting path."""
