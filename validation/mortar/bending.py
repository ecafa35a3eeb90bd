"""Peak moment of a section with mortar, by quadrature of the law over the section: what docs/mortar.md lists."""

import numpy as np
from scipy.optimize import brentq

_EDGE = {"joint": 0.25, "half": 0.5}  # stiffness of an edge in compression over that of the face


def traction(opening, b):
    """Of a point with the strength 1, the fracture energy 1 and the stiffness 1/b; softening exponential."""
    cracks = np.concatenate([[0], np.geomspace(1e-6, 60, 6000)])
    crack = np.interp(opening, cracks + b * np.exp(-cracks), cracks)
    return np.where(opening <= b, np.maximum(opening, 0) / b, np.exp(-crack))


def peak(b, edge="joint", fibres=400):
    """m = M / (f_t b h^2 / 6) at the peak, without an axial force, B = f_t^2 / (K G) = b. Compression acts at the edge."""
    place = (np.arange(fibres) + 0.5) / fibres - 0.5
    stiffness, most = _EDGE[edge] / b, 0
    for turn in np.geomspace(0.5 * b, 20, 400):
        def force(axis):
            return traction(turn * (place - axis), b).mean() - stiffness * turn * max(0, axis + 0.5)
        axis = brentq(force, -0.5, 0.5)
        moment = (traction(turn * (place - axis), b) * place).mean() + stiffness * turn * max(0, axis + 0.5) * 0.5
        most = max(most, 6 * moment)
    return most


def peak_elastic(b, fibres=400):
    """The same where compression is elastic over the whole section, as of a bed."""
    place, most = (np.arange(fibres) + 0.5) / fibres - 0.5, 0
    for turn in np.geomspace(0.5 * b, 40, 500):
        def stress(axis):
            opening = turn * (place - axis)
            return np.where(opening < 0, opening / b, traction(opening, b))
        axis = brentq(lambda x: stress(x).mean(), -0.5, 0.5)
        most = max(most, 6 * (stress(axis) * place).mean())
    return most
