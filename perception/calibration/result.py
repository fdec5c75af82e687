"""A rig calibrated in situ: its parameters, their covariance, what was observed, what error is left."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from executive.core.rig import RigCalibration
from executive.core.types import Array
from perception.calibration.parameters import NAMES, PARAMETERS, changed_rig
from perception.geometry.chain import Chain, ChainState
from perception.geometry.pose import Sighting, chi2_limit, estimate
from perception.geometry.rotation import log_map

OBSERVED = 0.5  # a parameter or direction is observed if the views halve its prior sigma at least


@dataclass(frozen=True)
class ParameterDirection:
    """A combination of parameters, in prior sigmas, and the share of its prior sigma that is left."""

    parts: tuple[tuple[str, float], ...]
    left: float

    def __str__(self) -> str:
        parts = " ".join(f"{weight:+.2f} {name}" for name, weight in self.parts)
        return f"{parts} ({self.left:.0%} of its prior left)"


@dataclass(frozen=True, eq=False)
class Calibrated:
    """`values` (k,) and `covariance` (k, k) are of the parameters in `NAMES`, departures from `believed`.

    What the views do not show keeps its prior: value 0, the prior's sigma. `chi2` of the images that count,
    with `dof`; `images` were given, `rejected` of them set aside as mismatched.
    """

    believed: RigCalibration
    values: Array
    covariance: Array
    prior_sigmas: Array
    temperature_k: float
    chi2: float
    dof: int
    images: int
    rejected: int
    converged: bool

    @property
    def rig(self) -> RigCalibration:
        """The rig for perception, at `temperature_k`."""
        return self.rig_at(self.temperature_k)

    def rig_at(self, temperature_k: float) -> RigCalibration:
        """The rig at another temperature of the head."""
        return changed_rig(self.believed, self.values, temperature_k - self.temperature_k)

    def consistent(self, probability: float = 0.999) -> bool:
        """Whether the residuals are as small as noise makes them with this probability."""
        return self.converged and self.chi2 <= chi2_limit(self.dof, probability)

    def sigma(self, name: str) -> float:
        """Standard deviation of a parameter, in its unit."""
        return float(np.sqrt(self.covariance[NAMES.index(name), NAMES.index(name)]))

    def value(self, name: str) -> float:
        """A parameter, in its unit."""
        return float(self.values[NAMES.index(name)])

    def observed(self) -> tuple[str, ...]:
        """The parameters that the views showed, each by itself."""
        left = np.sqrt(np.diag(self.covariance)) / self.prior_sigmas
        return tuple(name for name, share in zip(NAMES, left, strict=True) if share < OBSERVED)

    def unobserved(self) -> tuple[ParameterDirection, ...]:
        """Independent combinations of parameters that the views did not show, the least seen first."""
        shares, axes = np.linalg.eigh(self.covariance / np.outer(self.prior_sigmas, self.prior_sigmas))
        return tuple(
            _direction(axes[:, i], float(np.sqrt(shares[i])))
            for i in reversed(range(len(shares)))
            if shares[i] >= OBSERVED**2
        )

    def systematic_covariance(self, state: ChainState, centre_covariance_px2: Array) -> Array:
        """Covariance (6, 6) that what is left of the rig's error gives a pose estimated at `state`.

        It adds to the covariance of the fix, is common to all fixes there and does not average out. Centres
        have covariances (2, n, 2, 2), as in `Sighting`; they only weigh.
        """
        root = _square_root(self.covariance)
        shift = self._shift(state, centre_covariance_px2)
        by_root = np.stack([(shift(column) - shift(-column)) / 2 for column in root.T], axis=1)
        return np.asarray(by_root @ by_root.T)

    def _shift(self, state: ChainState, centre_covariance_px2: Array) -> Callable[[Array], Array]:
        """How an estimate with this rig errs when the true one has other parameters, (k,) -> (6,)."""
        chain = Chain.of(self.rig)

        def shift(other: Array) -> Array:
            uv, _ = Chain.of(changed_rig(self.rig, other)).project(state)
            seen = Sighting(uv, centre_covariance_px2, state.head_rad, state.joints_rad)
            body = estimate(chain, seen, state.site_body).state.site_body
            turn = log_map(body.rotation @ state.site_body.rotation.T)
            return np.concatenate([body.position_m - state.site_body.position_m, turn])

        return shift

    def __str__(self) -> str:
        fit = f"chi-square {self.chi2:.0f} of {self.dof}, {self.rejected} of {self.images} images set aside"
        rows = [
            f"{p.name:17s} {self.value(p.name):+.3e} ± {self.sigma(p.name):.1e} {p.unit:5s}"
            f" {'' if p.name in self.observed() else 'prior ' + format(prior, '.1e')}".rstrip()
            for p, prior in zip(PARAMETERS, self.prior_sigmas, strict=True)
        ]
        return "\n".join([fit, *rows, *(f"not observed: {direction}" for direction in self.unobserved())])


def _direction(axis: Array, left: float) -> ParameterDirection:
    strongest = sorted(range(len(axis)), key=lambda i: -abs(axis[i]))[:3]
    sign = np.sign(axis[strongest[0]])
    return ParameterDirection(
        tuple((NAMES[i], float(sign * axis[i])) for i in strongest if abs(axis[i]) > 0.3), left
    )


def _square_root(covariance: Array) -> Array:
    values, axes = np.linalg.eigh(covariance)
    root: Array = axes * np.sqrt(np.maximum(values, 0.0))
    return root
