"""Periodograms averaged over many sets, and what is read off them, as Ulichney (1988) and Lagae and Dutré (2008) do:
the mean power in rings of equal frequency, and the anisotropy, which is the variance within a ring over its mean
squared."""

from __future__ import annotations

import numpy as np
from analysis.estimators import Spectrum


class AveragedSpectrum:
    """The mean of the periodograms of several sets, each tapered (analysis.estimators.Spectrum); frequencies are waves
    a radius, and power is 1 for unrelated points."""

    def __init__(self, sets: list[np.ndarray], side: float, modes: int, edges: np.ndarray):
        assert sets, "needs a set"
        total, radial = 0.0, []
        for points in sets:
            spectrum = Spectrum(points, side, modes)
            total = total + spectrum.power
            radial.append(spectrum.radial(edges))
        self.sets, self.side, self.modes, self.edges = len(sets), side, modes, edges
        self.power = total / len(sets)
        self.frequency, self.angle = spectrum.frequency, spectrum.angle
        self.radial_of_sets = np.array(radial)

    def radial(self) -> np.ndarray:
        """Mean power of each ring."""
        return self.radial_of_sets.mean(axis=0)

    def radial_error(self) -> np.ndarray:
        """Its standard error, by the spread between the sets."""
        return self.radial_of_sets.std(axis=0, ddof=1) / np.sqrt(self.sets)

    def anisotropy(self) -> np.ndarray:
        """Of each ring, in decibels. A set without directions has about noise_level(sets), whatever its spectrum."""
        ring = np.digitize(self.frequency, self.edges) - 1
        values = [self.power[ring == index] for index in range(len(self.edges) - 1)]
        return np.array([10.0 * np.log10(power.var(ddof=1) / power.mean() ** 2) for power in values])

    def image(self) -> np.ndarray:
        """Power over the plane of frequencies, (2 modes + 1) squared, zero in the middle; rows go up with y. What the
        mean density spoils is 0."""
        picture = np.zeros((2 * self.modes + 1, 2 * self.modes + 1))
        i = np.round(self.frequency * self.side * np.cos(self.angle)).astype(int)
        j = np.round(self.frequency * self.side * np.sin(self.angle)).astype(int)
        picture[self.modes + j, self.modes + i] = self.power
        picture[self.modes - j, self.modes - i] = self.power
        return picture


def noise_level(sets: int) -> float:
    """Anisotropy, in decibels, of an average of so many periodograms of a set without directions: the power of one wave
    spreads as much as its mean, and averaging divides the variance."""
    return -10.0 * np.log10(sets)


def ring_edges(modes: int, side: float, rings: int) -> np.ndarray:
    """Edges of rings of equal width, from beyond the waves that the mean density spoils to the highest frequency."""
    return np.linspace(4.0 / side, modes / side, rings + 1)
