"""Averages periodograms over many sets, and derives values from them, as in Ulichney (1988) and Lagae and Dutré (2008).
These are the mean power in rings of equal frequency, and the anisotropy, which is the variance within a ring divided by
its squared mean."""

from __future__ import annotations

import numpy as np
from analysis.estimators import Spectrum


class AveragedSpectrum:
    """The mean of the periodograms of several sets, each tapered (analysis.estimators.Spectrum). Frequencies are waves
    per radius, and power is 1 for unrelated points."""

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
        """Returns the mean power of each ring."""
        return self.radial_of_sets.mean(axis=0)

    def radial_error(self) -> np.ndarray:
        """Returns the standard error of each ring's power, from the spread between the sets."""
        return self.radial_of_sets.std(axis=0, ddof=1) / np.sqrt(self.sets)

    def anisotropy(self) -> np.ndarray:
        """Returns the anisotropy of each ring in decibels. An isotropic set has about noise_level(sets), regardless of
        its spectrum."""
        ring = np.digitize(self.frequency, self.edges) - 1
        values = [self.power[ring == index] for index in range(len(self.edges) - 1)]
        return np.array([10.0 * np.log10(power.var(ddof=1) / power.mean() ** 2) for power in values])

    def image(self) -> np.ndarray:
        """Returns the power over the plane of frequencies, (2 modes + 1) squared, with frequency zero at the center.
        Rows ascend with y. Frequencies that the mean density affects are 0."""
        picture = np.zeros((2 * self.modes + 1, 2 * self.modes + 1))
        i = np.round(self.frequency * self.side * np.cos(self.angle)).astype(int)
        j = np.round(self.frequency * self.side * np.sin(self.angle)).astype(int)
        picture[self.modes + j, self.modes + i] = self.power
        picture[self.modes - j, self.modes - i] = self.power
        return picture


def noise_level(sets: int) -> float:
    """Returns the anisotropy, in decibels, of an average of this many periodograms of an isotropic set. The standard
    deviation of one wave's power equals its mean, and averaging divides the variance."""
    return -10.0 * np.log10(sets)


def ring_edges(modes: int, side: float, rings: int) -> np.ndarray:
    """Returns the edges of rings of equal width, from just above the frequencies that the mean density affects to the
    highest frequency."""
    return np.linspace(4.0 / side, modes / side, rings + 1)
