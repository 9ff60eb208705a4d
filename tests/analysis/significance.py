"""Hypothesis tests whose p-values are exact for normal data. All tests take one row of features for each independent set (a seed). The correlation
between features is estimated from these rows, so no bound needs tuning."""

from __future__ import annotations

import numpy as np
from scipy import stats


def _hotelling_p(squared: float, features: int, freedom: int) -> float:
    """Returns the p-value of Hotelling's T^2 with `freedom` degrees of freedom in the covariance."""
    below = freedom - features + 1
    assert below > 0, "there must be more independent sets than features"
    return float(stats.f.sf(squared * below / (features * freedom), features, below))


def _mahalanobis(difference: np.ndarray, covariance: np.ndarray) -> float:
    scale = np.sqrt(np.diag(covariance))
    scale[scale == 0.0] = 1.0
    scaled = covariance / np.outer(scale, scale)
    return float((difference / scale) @ np.linalg.solve(scaled, difference / scale))


def mean_differs_from(rows: np.ndarray, expected) -> float:
    """Returns the p-value of "the mean of the rows is `expected`" (Hotelling's one-sample test)."""
    count, features = rows.shape
    difference = rows.mean(axis=0) - expected
    covariance = np.atleast_2d(np.cov(rows, rowvar=False))
    return _hotelling_p(count * _mahalanobis(difference, covariance), features, count - 1)


def means_differ(rows_a: np.ndarray, rows_b: np.ndarray) -> float:
    """Returns the p-value of "both have the same mean" (Hotelling's two-sample test, pooled covariance)."""
    count_a, features = rows_a.shape
    count_b = rows_b.shape[0]
    freedom = count_a + count_b - 2
    pooled = (
        (count_a - 1) * np.atleast_2d(np.cov(rows_a, rowvar=False))
        + (count_b - 1) * np.atleast_2d(np.cov(rows_b, rowvar=False))
    ) / freedom
    difference = rows_a.mean(axis=0) - rows_b.mean(axis=0)
    squared = count_a * count_b / (count_a + count_b) * _mahalanobis(difference, pooled)
    return _hotelling_p(squared, features, freedom)


def z_of_mean(values: np.ndarray, expected: float) -> float:
    """Returns the distance between the mean of independent values and `expected`, in standard errors estimated from the values."""
    values = np.asarray(values, dtype=float)
    return float((values.mean() - expected) / (values.std(ddof=1) / np.sqrt(len(values))))
