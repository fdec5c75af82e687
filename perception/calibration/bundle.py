"""The bundle: residuals of all images and readings, and their Jacobian, analytic but for the parameters."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from executive.core.rig import RigCalibration
from executive.core.types import Array
from perception.calibration.parameters import changed_rig
from perception.calibration.readings import readings
from perception.calibration.survey import Survey
from perception.calibration.target_images import Indices, TargetImages
from perception.calibration.unknowns import Unknowns, turn_rate
from perception.geometry.camera import StereoModel
from perception.geometry.chain import Chain
from perception.geometry.head_model import head_rates, site_ih
from perception.geometry.rotation import skew

_PROBE = 1e-3  # of a prior sigma, for central differences by the rig's parameters


@dataclass(frozen=True, eq=False)
class Bundle:
    """The least-squares problem of a survey, all residuals in sigmas. `sigmas` (k,) are the priors."""

    rig: RigCalibration
    survey: Survey
    sightings: TargetImages
    unknowns: Unknowns
    sigmas: Array
    temperature_k: float

    def residuals(self, x: Array) -> Array:
        """Images that count (2 a piece), then everything else."""
        return np.concatenate([self.image_residuals(x)[self.sightings.seen].ravel(), self._readings_of(x)[0]])

    def jacobian(self, x: Array) -> sparse.csr_matrix:
        by_x = self._images_by_unknowns(x)[np.repeat(self.sightings.seen.ravel(), 2)]
        return sparse.csr_matrix(sparse.vstack([by_x, self._readings_of(x)[1]]))

    def dense_jacobian(self, x: Array) -> Array:
        return np.asarray(self.jacobian(x).toarray())

    def image_residuals(self, x: Array) -> Array:
        """Measured less predicted of each image (2, N, 2) in sigmas, NaN where none is seen."""
        uv, _ = self._project(self._values(x), self.unknowns.pointing(x), self._targets(x, self._values(x)))
        off: Array = (self.sightings.uv_px - uv) / self.sightings.sigma_px[..., None]
        return off

    def degrees_of_freedom(self) -> int:
        """Residuals less what they have to determine; a point takes no more than its images give."""
        points = self.sightings.images_of_targets()[self._marker_targets :]
        free = np.array([name not in self.survey.landmarks for name in self.sightings.names], dtype=bool)
        taken = int(np.minimum(2 * points[free], 3).sum())
        return 2 * int(self.sightings.seen.sum()) - taken - 4 * len(self.survey.stations)

    @property
    def _marker_targets(self) -> int:
        return len(self.survey.stations) * len(self.rig.markers.positions_plc_m)

    def _readings_of(self, x: Array) -> tuple[Array, sparse.csr_matrix]:
        return readings(self.rig, self.survey, self.sightings.names, self.unknowns, x)

    def _values(self, x: Array) -> Array:
        return x[: self.unknowns.parameters] * self.sigmas

    def _targets(self, x: Array, values: Array) -> Array:
        """Where all targets are in site (T, 3)."""
        markers = np.array(changed_rig(self.rig, values).markers.positions_plc_m)
        at_stations = [self.unknowns.station(x, s).apply(markers) for s in range(len(self.survey.stations))]
        points = [self.unknowns.point(x, p)[0][None] for p in range(len(self.sightings.names))]
        return np.concatenate([*at_stations, *points])

    def _project(self, values: Array, pointing: Array, targets_m: Array) -> tuple[Array, Array]:
        """Pixels (2, N, 2) of all sightings, and their derivatives (2, N, 2, 3) by the point in `ih`."""
        rows = self.sightings
        head = changed_rig(self.rig, values).head
        turns = np.stack([site_ih(head, reading).rotation for reading in self._readings(pointing)])
        from_mast = targets_m[rows.target] - [0.0, 0.0, head.mast_height_m]
        in_head = np.einsum("nji,nj->ni", turns[rows.look], from_mast)
        uv, by_ih = np.empty((2, len(rows.look), 2)), np.empty((2, len(rows.look), 2, 3))
        warmer_k = np.array([look.temperature_k for look in self.survey.looks]) - self.temperature_k
        for warmer in np.unique(warmer_k):
            model = StereoModel.of(changed_rig(self.rig, values, float(warmer)))
            at = warmer_k[rows.look] == warmer
            uv[:, at], by_ih[:, at] = model.project_with_jacobian(in_head[at])
        return uv, by_ih

    def _readings(self, pointing: Array) -> list[tuple[float, float]]:
        """Encoder readings of a head that had pointed exactly where each look did point."""
        sigma = Chain.of(self.rig).encoder_sigma_rad()[:2]
        said = np.array([look.head_rad for look in self.survey.looks])
        return [(float(pan), float(tilt)) for pan, tilt in said + pointing * sigma]

    def _images_by_unknowns(self, x: Array) -> sparse.csr_matrix:
        """Jacobian of all image residuals (4 N, unknowns)."""
        values, pointing = self._values(x), self.unknowns.pointing(x)
        targets = self._targets(x, values)
        _, by_ih = self._project(values, pointing, targets)
        blocks = [
            self._by_parameters(x, values),
            self._by_pointing(values, pointing, targets, by_ih),
            *self._by_places(x, values, pointing, by_ih),
        ]
        weight = -1 / self.sightings.sigma_px[:, :, None, None]
        shape = (4 * len(self.sightings.look), self.unknowns.size)
        index = np.arange(shape[0]).reshape(2, -1, 2, 1)
        J = sparse.csr_matrix(shape)
        for rows, columns, by in blocks:
            at = np.broadcast_to(index[:, rows], by.shape).ravel()
            where = np.broadcast_to(columns[None, :, None, :], by.shape).ravel()
            J = J + sparse.csr_matrix(((by * weight[:, rows]).ravel(), (at, where)), shape=shape)
        return J

    def _by_parameters(self, x: Array, values: Array) -> tuple[Indices, Indices, Array]:
        """Central differences, since a parameter may do anything to a rig."""
        pointing, steps = self.unknowns.pointing(x), np.diag(self.sigmas * _PROBE)

        def uv(moved: Array) -> Array:
            return self._project(moved, pointing, self._targets(x, moved))[0]

        by = [(uv(values + step) - uv(values - step)) / (2 * _PROBE) for step in steps]
        rows = np.arange(len(self.sightings.look))
        columns = np.broadcast_to(np.arange(len(steps)), (len(rows), len(steps)))
        return rows, columns, np.stack(by, axis=-1)

    def _by_pointing(
        self, values: Array, pointing: Array, targets_m: Array, by_ih: Array
    ) -> tuple[Indices, Indices, Array]:
        rows, sigma = self.sightings, Chain.of(self.rig).encoder_sigma_rad()[:2]
        head = changed_rig(self.rig, values).head
        rates = np.array([head_rates(head, reading) for reading in self._readings(pointing)])
        from_mast = targets_m[rows.target] - [0.0, 0.0, head.mast_height_m]
        in_head = np.einsum("nkji,nj->nik", rates[rows.look], from_mast) * sigma
        columns = self.unknowns.first_look + 2 * rows.look[:, None] + np.arange(2)
        return np.arange(len(rows.look)), columns, by_ih @ in_head

    def _by_places(
        self, x: Array, values: Array, pointing: Array, by_ih: Array
    ) -> list[tuple[Indices, Indices, Array]]:
        """By the poses of the stations, and by the points."""
        rows, head = self.sightings, changed_rig(self.rig, values).head
        turns = np.stack([site_ih(head, reading).rotation for reading in self._readings(pointing)])
        by_site = by_ih @ np.swapaxes(turns, 1, 2)[rows.look]
        places = self._places(x, values)
        of_rover = rows.target < self._marker_targets
        blocks = []
        for group, first, width in (
            (of_rover, self.unknowns.first_station, 6),
            (~of_rover, self.unknowns.first_point, 3),
        ):
            at = np.flatnonzero(group)
            if len(at) == 0:
                continue
            per = len(self.rig.markers.positions_plc_m) if width == 6 else 1
            item = (rows.target[at] - (0 if width == 6 else self._marker_targets)) // per
            columns = first + width * item[:, None] + np.arange(width)
            moves = np.stack([places[target] for target in rows.target[at]])
            blocks.append((at, columns, by_site[:, at] @ moves))
        return blocks

    def _places(self, x: Array, values: Array) -> list[Array]:
        """How each target moves with its own unknowns: (3, 6) for markers, (3, 3) for points."""
        markers = np.array(changed_rig(self.rig, values).markers.positions_plc_m)
        moves = []
        for s in range(len(self.survey.stations)):
            arms = markers @ self.unknowns.station(x, s).rotation.T
            rate = turn_rate(self.unknowns.station_step(x, s)[3:])
            moves += [np.hstack([np.eye(3), -skew(arm) @ rate]) for arm in arms]
        return moves + [self.unknowns.point(x, p)[1] for p in range(len(self.sightings.names))]
