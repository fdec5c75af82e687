"""The camera of a far trial: a window's expected light, and frames of it with the noise of a real sensor.

What disturbs it comes in through the hooks of a Disturbance, so that undisturbed frames cost nothing more.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache

import cv2
import numpy as np

from executive.core.types import Window
from perception.frames.codes import lit
from perception.frames.psf import marker_spread
from tests.perception.sensor.noise import with_noise
from tests.perception.synthetic import (
    BITS,
    GAIN_E,
    READ_E,
    Scene,
    background_e,
    marker_electrons,
    spot,
)

FULL = 2**BITS - 1
_RIM_PX = 4  # of ground around the window, which comes in when the head vibrates
_SHEET_PX = 2048


@dataclass(frozen=True)
class Nuisance:
    """What real frames do over a sequence: jitter a frame, drift in all [px], change of light in all."""

    jitter_px: float = 0.0
    drift_px: float = 0.0
    light: float = 0.0
    texture: float = 0.08

    @property
    def moves(self) -> bool:
        return (self.jitter_px, self.drift_px, self.light) != (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Stage:
    """What a disturbance may look at: the scene, both windows, the LED masks ordered."""

    scene: Scene
    windows: tuple[Window, Window]
    leds: tuple[int, ...]

    @property
    def ordered(self) -> np.ndarray:
        """1 where an LED is to be on, (frames, 4)."""
        return lit(self.leds, 4)


@dataclass(frozen=True)
class Glint:
    """Light that is not a marker: full-frame pixels in both cameras (2, 2), each a flux [e-], by frame."""

    uv_px: np.ndarray
    flux_e: float
    power: np.ndarray


class Disturbance:
    """None. Subclasses override what they disturb; an object lives for one trial, drawn in `begin`."""

    psf_scale = 1.0  # width of the point spread
    contrast = 1.0  # of what is seen through the dust

    def begin(self, stage: Stage, rng: np.random.Generator) -> None:
        """Draw what there is to draw."""

    def power(self, stage: Stage) -> np.ndarray:
        """Light of each LED in each frame (frames, 4), 1 at full power."""
        return stage.ordered

    def glints(self) -> list[Glint]:
        """Lights besides the markers."""
        return []

    def shift_px(self, frame: int) -> tuple[float, float]:
        """How far the scene is moved in a frame."""
        return 0.0, 0.0

    def ground(self, camera: int, ground_e: np.ndarray) -> np.ndarray:
        """The ground of all frames (h, w) [e-]."""
        return ground_e

    def light(self, camera: int, frame: int, ground_e: np.ndarray) -> np.ndarray:
        """The ground as it is lit in a frame."""
        return ground_e

    def delivered(self, camera: int, first: int, counts: np.ndarray) -> np.ndarray:
        """What is read out of the frames from number `first` on [counts]."""
        return counts

    @property
    def vibrates(self) -> bool:
        return type(self).shift_px is not Disturbance.shift_px

    @property
    def relit(self) -> bool:
        return type(self).light is not Disturbance.light

    @property
    def crossed(self) -> bool:
        """Whether each camera's window is read out of the other."""
        return False


@dataclass
class TrialCamera:
    """One camera's window: ground with a rim and its slopes, LEDs and glints with their light by frame."""

    stage: Stage
    camera: int
    ground_e: np.ndarray
    spots: list[_Spot]
    nuisance: Nuisance
    disturbance: Disturbance
    slopes_e: tuple[np.ndarray, np.ndarray] | None = field(init=False)

    def __post_init__(self) -> None:
        inner = self.ground_e[_RIM_PX:-_RIM_PX, _RIM_PX:-_RIM_PX]
        self.slopes_e = tuple(np.gradient(inner)[::-1]) if self.nuisance.moves else None
        self._inner_e = inner

    @classmethod
    def of(
        cls,
        stage: Stage,
        camera: int,
        rng: np.random.Generator,
        nuisance: Nuisance,
        disturbance: Disturbance,
        dark: bool,
    ) -> TrialCamera:
        ground = disturbance.ground(camera, _ground_e(nuisance.texture, stage.windows[camera], rng))
        eye = 1 - camera if disturbance.crossed else camera
        power = disturbance.power(stage) * (0.0 if dark else disturbance.contrast)
        corner = stage.windows[camera].u, stage.windows[camera].v
        scene, widen = stage.scene, disturbance.psf_scale
        spots = [
            _Spot.of(
                scene.uv_px[eye, m] - corner,
                scene.ranges_m[eye, m],
                widen,
                flux_e(scene, eye, m) * power[:, m],
                stage,
                camera,
            )
            for m in range(4)
        ]
        spots += [
            _Spot.of(g.uv_px[eye] - corner, scene.range_m, widen, g.flux_e * g.power, stage, camera)
            for g in disturbance.glints()
        ]
        return cls(stage, camera, ground, spots, nuisance, disturbance)

    def expose(self, part: slice, rng: np.random.Generator) -> np.ndarray:
        """Frames of a part of the sequence [counts]."""
        leds = self.stage.leds
        first, last, _ = part.indices(len(leds))
        expected = np.empty((last - first, *self._inner_e.shape), dtype=np.float32)
        for k, light in enumerate(expected, first):
            light[:] = self._ground_in(k, k / len(leds), rng)
            shift = self.disturbance.shift_px(k)
            for spot_ in self.spots:
                spot_.add_to(light, k, shift)
        counts = with_noise(rng, expected, READ_E, GAIN_E, float(FULL))
        return self.disturbance.delivered(self.camera, first, counts)

    def _ground_in(self, frame: int, progress: float, rng: np.random.Generator) -> np.ndarray:
        ground = self._inner_e
        if self.disturbance.vibrates:
            ground = _moved(self.ground_e, self.disturbance.shift_px(frame))
        if self.slopes_e is not None:
            n = self.nuisance
            du, dv = n.drift_px * progress + n.jitter_px * rng.standard_normal(2)
            ground = ground - du * self.slopes_e[0] - dv * self.slopes_e[1]
            ground *= 1 + n.light * np.sin(2 * np.pi * progress)
        if self.disturbance.relit:
            return self.disturbance.light(self.camera, frame, ground)
        return ground


@dataclass
class _Spot:
    """One light in a window: where, how wide, its light by frame [e-], its image where nothing moves."""

    uv_px: np.ndarray
    range_m: float
    widen: float
    light_e: np.ndarray
    place: tuple[slice, slice]
    shape: tuple[int, int]
    still: np.ndarray

    @classmethod
    def of(cls, uv_px, range_m, widen, light_e, stage: Stage, camera: int) -> _Spot:
        window, rig = stage.windows[camera], stage.scene.chain.rig
        reach = int(4 * widen * marker_spread(rig, float(range_m)).radius_px)
        left, top = (max(round(float(np.clip(at, -1e6, 1e6))) - reach, 0) for at in uv_px)
        place = slice(top, max(top + 2 * reach, 0)), slice(left, max(left + 2 * reach, 0))
        shape = tuple(len(range(n)[s]) for n, s in zip((window.height, window.width), place, strict=True))
        still = spot(shape, uv_px[0] - left, uv_px[1] - top, range_m, widen=widen)
        return cls(uv_px, range_m, widen, light_e, place, shape, still.astype(np.float32))

    def add_to(self, expected_e: np.ndarray, frame: int, shift_px: tuple[float, float]) -> None:
        light = self.light_e[frame]
        if light <= 0:
            return
        share = self.still
        if shift_px != (0.0, 0.0):
            u, v = self.uv_px + shift_px - (self.place[1].start, self.place[0].start)
            share = spot(self.shape, u, v, self.range_m, widen=self.widen)
        expected_e[self.place] += np.float32(light) * share.astype(np.float32)


def flux_e(scene: Scene, camera: int, marker: int) -> float:
    """Light of one marker as a camera sees it [e-]."""
    return marker_electrons(scene.ranges_m[camera, marker]) * (1 + scene.cosines[camera, marker]) / 2


def _moved(ground_e: np.ndarray, shift_px: tuple[float, float]) -> np.ndarray:
    """The inner part of the ground, moved by a few pixels."""
    height, width = (n - 2 * _RIM_PX for n in ground_e.shape)
    there = np.array([[1.0, 0.0, _RIM_PX - shift_px[0]], [0.0, 1.0, _RIM_PX - shift_px[1]]])
    flags = cv2.INTER_CUBIC | cv2.WARP_INVERSE_MAP
    return cv2.warpAffine(ground_e, there, (width, height), flags=flags, borderMode=cv2.BORDER_REFLECT)


@cache
def _sheet_e(texture: float) -> np.ndarray:
    """Ground for all trials, made once; each takes a place of its own."""
    return background_e(np.random.default_rng(0), (_SHEET_PX, _SHEET_PX), texture).astype(np.float32)


def _ground_e(texture: float, w: Window, rng) -> np.ndarray:
    """The ground of a window with its rim."""
    rim = 2 * _RIM_PX
    v, u = (int(rng.integers(_SHEET_PX - rim - size + 1)) for size in (w.height, w.width))
    return _sheet_e(texture)[v : v + w.height + rim, u : u + w.width + rim]
