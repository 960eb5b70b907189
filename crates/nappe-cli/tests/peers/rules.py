"""Rules for integrals, for the scripts beside."""

import math


def gauss(n):
    """The nodes and weights of Gauss and Legendre on [0, 1], by Newton's method."""
    out = []
    for i in range(n):
        x = math.cos(math.pi * (i + 0.75) / (n + 0.5))
        for _ in range(50):
            p, q = 1.0, x
            for k in range(2, n + 1):
                p, q = q, ((2 * k - 1) * x * q - (k - 1) * p) / k
            slope = n * (x * q - p) / (x * x - 1)
            x -= q / slope
        out.append(((1 + x) / 2, 1 / ((1 - x * x) * slope * slope)))
    return out
