"""Whether a series grows: a linear trend that is significant and larger than a bound."""

import dataclasses
import math

import numpy as np

BLOCKS = 16  # means of blocks are nearly independent, unlike single samples
SIGNIFICANT = 4.0  # t value of the slope; with 14 degrees of freedom p = 0.0007


@dataclasses.dataclass
class Trend:
    """The trend of a series behind its warm-up."""

    start: float  # at the end of the warm-up
    growth: float  # extrapolated over the whole series
    t: float  # the slope over its standard error

    def exceeds(self, bound):
        """Whether the growth is significant and larger than the bound."""
        return self.growth > bound and self.t > SIGNIFICANT


def trend(counts, values, warm_up=0.2):
    """The trend of values over the number of repetitions, by least squares over means of blocks.

    warm_up is the share of the series in which caches fill. It is left out.
    """
    counts, values = np.asarray(counts, float), np.asarray(values, float)
    late = counts > counts[0] + warm_up * (counts[-1] - counts[0])
    x, y = counts[late], values[late]
    if len(x) < 2 * BLOCKS:
        raise ValueError(f"a trend needs {2 * BLOCKS} samples behind the warm-up, has {len(x)}")
    x = np.array([part.mean() for part in np.array_split(x, BLOCKS)])
    y = np.array([part.mean() for part in np.array_split(y, BLOCKS)])
    away = x - x.mean()
    slope = (away @ y) / (away @ away)
    start = y.mean() + slope * (x[0] - x.mean())
    residual = y - y.mean() - slope * away
    error = math.sqrt((residual @ residual) / (BLOCKS - 2) / (away @ away))
    # Rounding alone makes no trend of a constant series.
    if abs(slope) * (counts[-1] - counts[0]) < 1e-9 * max(1.0, abs(start)):
        return Trend(start, 0.0, 0.0)
    return Trend(start, slope * (counts[-1] - counts[0]), slope / error if error > 0 else math.copysign(math.inf, slope))
