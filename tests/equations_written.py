"""Systems as their sources print them, with the order that each must have."""

from __future__ import annotations

from typing import Any

_LAPLACIAN = "(d({0},2) + d({0})/r - (n**2+1)*{0}/r**2 - a**2*{0})"

WRITTEN: dict[str, dict[str, Any]] = {
    "plane Poiseuille flow": {
        "unknowns": ["u", "v", "p"],
        "parameters": {"R": 10000, "a": 1},
        "where": {"U": "1 - z**2"},
        "equations": [
            "sigma*u + i*a*U*u + v*d(U) + i*a*p - (d(u,2) - a**2*u)/R",
            "sigma*v + i*a*U*v + d(p) - (d(v,2) - a**2*v)/R",
            "i*a*u + d(v)",
        ],
        "order": 4,
    },
    "plane Poiseuille flow, spatial": {
        "unknowns": ["u", "v", "p"],
        "parameters": {"R": 10000, "omega": 0.2375},
        "where": {"U": "1 - z**2"},
        "eigenvalue": "a",
        "equations": [
            "-i*omega*u + i*a*U*u + v*d(U) + i*a*p - (d(u,2) - a**2*u)/R",
            "-i*omega*v + i*a*U*v + d(p) - (d(v,2) - a**2*v)/R",
            "i*a*u + d(v)",
        ],
        "order": 4,
    },
    "Orr-Sommerfeld with Squire": {
        "unknowns": ["u", "v", "w", "p"],
        "parameters": {"R": 5000, "a": 1, "b": 0.7},
        "where": {"U": "1 - z**2"},
        "equations": [
            "sigma*u + i*a*U*u + w*d(U) + i*a*p - (d(u,2) - (a**2+b**2)*u)/R",
            "sigma*v + i*a*U*v + i*b*p - (d(v,2) - (a**2+b**2)*v)/R",
            "sigma*w + i*a*U*w + d(p) - (d(w,2) - (a**2+b**2)*w)/R",
            "i*a*u + i*b*v + d(w)",
        ],
        "order": 6,
    },
    "Rayleigh, in primitive variables": {
        "unknowns": ["u", "v", "p"],
        "parameters": {"a": 0.4446},
        "where": {"U": "tanh(z)"},
        "equations": ["(sigma + i*a*U)*u + v*d(U) + i*a*p", "(sigma + i*a*U)*v + d(p)", "i*a*u + d(v)"],
        "order": 2,
    },
    "Taylor-Goldstein with the buoyancy": {
        "unknowns": ["u", "w", "p", "b"],
        "parameters": {"a": 0.5, "J": 0.1},
        "where": {"U": "tanh(z)"},
        "equations": [
            "(sigma + i*a*U)*u + w*d(U) + i*a*p",
            "(sigma + i*a*U)*w + d(p) - b",
            "i*a*u + d(w)",
            "(sigma + i*a*U)*b + J*sech(z)**2*w",
        ],
        "order": 2,
    },
    "Benard, in primitive variables": {
        "unknowns": ["u", "w", "p", "T"],
        "parameters": {"a": 3.117, "Pr": 0.71, "Ra": 1707.762},
        "equations": [
            "sigma*u/Pr + i*a*p - (d(u,2) - a**2*u)",
            "sigma*w/Pr + d(p) - (d(w,2) - a**2*w) - Ra*T",
            "i*a*u + d(w)",
            "sigma*T - w - (d(T,2) - a**2*T)",
        ],
        "order": 6,
    },
    "pipe flow": {
        "unknowns": ["u", "v", "w", "p"],
        "parameters": {"a": 1, "n": 1, "R": 3000},
        "where": {"W": "1 - r**2"},
        "variable": "r",
        "equations": [
            f"(sigma + i*a*W)*u + d(p) - ({_LAPLACIAN.format('u')} - 2*i*n*v/r**2)/R",
            f"(sigma + i*a*W)*v + i*n*p/r - ({_LAPLACIAN.format('v')} + 2*i*n*u/r**2)/R",
            "(sigma + i*a*W)*w + u*d(W) + i*a*p - (d(w,2) + d(w)/r - n**2*w/r**2 - a**2*w)/R",
            "d(u) + u/r + i*n*v/r + i*a*w",
        ],
        "from": 0.0,
        "order": 6,
    },
    "Taylor-Couette flow": {
        "unknowns": ["u", "v", "w", "p"],
        "parameters": {"k": 3.13, "Re": 68.2, "q": 0.5},
        "where": {"A": "-Re*q/(1+q)", "B": "Re*q/((1-q)*(1-q**2))", "V": "A*r + B/r"},
        "variable": "r",
        "equations": [
            "sigma*u - 2*V*v/r + d(p) - (d(u,2) + d(u)/r - u/r**2 - k**2*u)",
            "sigma*v + (d(V) + V/r)*u - (d(v,2) + d(v)/r - v/r**2 - k**2*v)",
            "sigma*w + i*k*p - (d(w,2) + d(w)/r - k**2*w)",
            "d(u) + u/r + i*k*w",
        ],
        "from": 1.0,
        "to": 2.0,
        "order": 6,
    },
    "a compressible layer": {
        "unknowns": ["u", "v", "p", "T"],
        "parameters": {"a": 1, "R": 1000, "g": 1.4, "M": 2},
        "where": {"U": "z"},
        "equations": [
            "(sigma + i*a*U)*u + v*d(U) + i*a*p - (d(u,2) - a**2*u)/R",
            "(sigma + i*a*U)*v + d(p) - (d(v,2) - a**2*v)/R",
            "(sigma + i*a*U)*(g*M**2*p - T) + i*a*u + d(v)",
            "(sigma + i*a*U)*T + (g-1)*(i*a*u + d(v)) - (d(T,2) - a**2*T)/R",
        ],
        "order": 6,
    },
    "heat conduction with a cross flux": {
        "unknowns": ["T", "c"],
        "where": {"K": "2 + sin(z)", "L": "exp(-z)"},
        "equations": ["sigma*T - d(K*d(T)) + d(L*d(c))", "(sigma + i*tanh(z))*d(c) + (1 + z**2)*d(T) + sqrt(2 + z)*c"],
        "order": 3,
    },
    "a bar on an elastic ground, sigma squared": {
        "unknowns": ["w", "m"],
        "equations": ["sigma**2*w + d(m,2) + erf(z)*w + sigma**3*m", "d(w,2) - m/log(3 + z)"],
        "order": 4,
    },
}
