"""What disturbs a localisation, one thing at a time, each drawn anew for a trial within its stated extent.

Named like the faults of the catalogue where there is one. `MATRIX` pairs each with the reasons that say what
is wrong, or the truth: a refusal with one of these is right, any other is not.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np

from tests.perception.trial_camera import FULL, Disturbance, Glint, Stage, flux_e

_FULL_WELL_E = 160_000.0


# -- LEDs


class LedOff(Disturbance):
    """One LED dead, or two."""

    def begin(self, stage: Stage, rng: np.random.Generator) -> None:
        self.dead = rng.choice(4, rng.integers(1, 3), replace=False)

    def power(self, stage: Stage) -> np.ndarray:
        power = stage.ordered
        power[:, self.dead] = 0.0
        return power


class LedDim(Disturbance):
    """One to three LEDs at 30 to 70 % of their power."""

    def begin(self, stage: Stage, rng: np.random.Generator) -> None:
        self.factor = np.ones(4)
        dim = rng.choice(4, rng.integers(1, 4), replace=False)
        self.factor[dim] = rng.uniform(0.3, 0.7, len(dim))

    def power(self, stage: Stage) -> np.ndarray:
        return stage.ordered * self.factor


class LedStuckOn(Disturbance):
    """One LED lit in every frame, or two."""

    def begin(self, stage: Stage, rng: np.random.Generator) -> None:
        self.stuck = rng.choice(4, rng.integers(1, 3), replace=False)

    def power(self, stage: Stage) -> np.ndarray:
        power = stage.ordered
        power[:, self.stuck] = 1.0
        return power


class LedSwapped(Disturbance):
    """Two LEDs on each other's lines, or two such couples."""

    def begin(self, stage: Stage, rng: np.random.Generator) -> None:
        self.line, order = np.arange(4), rng.permutation(4)
        for a, b in order.reshape(2, 2)[: rng.integers(1, 3)]:
            self.line[[a, b]] = b, a

    def power(self, stage: Stage) -> np.ndarray:
        return stage.ordered[:, self.line]


class FalseReflection(Disturbance):
    """One to five glints around the plate, 0.3 to 2 times as bright as a marker, most of them blinking with
    an LED, some steady; most at one place in space, some elsewhere in each camera, as mirror images are."""

    def begin(self, stage: Stage, rng: np.random.Generator) -> None:
        self._glints = [self._draw(stage, rng) for _ in range(rng.integers(1, 6))]

    def _draw(self, stage: Stage, rng: np.random.Generator) -> Glint:
        scene, chain = stage.scene, stage.scene.chain
        place = chain.markers_site(scene.state).mean(axis=0) + rng.uniform(-1, 1, 3) * [0.25, 0.25, 0.12]
        head = chain.site_ih(scene.state.head_rad)
        uv = chain.model.project(((place - head.position_m) @ head.rotation)[None])[:, 0]
        if rng.random() < 0.3:
            uv = uv + rng.uniform(-0.05, 0.05, (2, 2)) * 2500.0 / scene.range_m
        led = int(rng.integers(4))
        blinks = rng.random() < 0.8
        power = stage.ordered[:, led] if blinks else np.ones(len(stage.leds))
        return Glint(uv, flux_e(scene, 0, led) * rng.uniform(0.3, 2.0), power)

    def glints(self) -> list[Glint]:
        return self._glints


# -- light


class Glare(Disturbance):
    """A patch that saturates, 2 to 8 px in radius, with a soft rim and bloom all along its columns."""

    def begin(self, stage: Stage, rng: np.random.Generator) -> None:
        self.radius_px = rng.uniform(2.0, 8.0)
        self.place = rng.random((2, 2))
        self.bloom_e = _FULL_WELL_E * rng.uniform(0.2, 0.8)

    def ground(self, camera: int, ground_e: np.ndarray) -> np.ndarray:
        v, u = self.place[camera] * ground_e.shape
        rows, columns = (np.arange(n, dtype=np.float32) for n in ground_e.shape)
        apart = np.hypot((rows - v)[:, None], (columns - u)[None])
        patch = 4 * _FULL_WELL_E / (1 + np.exp(np.minimum(2 * (apart - self.radius_px), 50)))
        bloom = self.bloom_e * (np.abs(columns - u) < self.radius_px)
        return (ground_e + patch + bloom).astype(np.float32)


class MovingShadow(Disturbance):
    """The edge of a shadow, half as bright as the sunlit ground, goes through part of the window or all of it
    while the frames are taken."""

    def begin(self, stage: Stage, rng: np.random.Generator) -> None:
        self.frames = len(stage.leds)
        angle = rng.uniform(0, 2 * np.pi)
        self.along = np.array([np.cos(angle), np.sin(angle)])
        self.penumbra_px = rng.uniform(1.0, 6.0)
        self.way = np.sort(rng.uniform(-0.5, 0.5, 2)) if rng.random() < 0.5 else (-0.5, 0.5)

    def light(self, camera: int, frame: int, ground_e: np.ndarray) -> np.ndarray:
        height, width = ground_e.shape
        u = (np.arange(width, dtype=np.float32) - width / 2) * np.float32(self.along[0])
        v = (np.arange(height, dtype=np.float32) - height / 2) * np.float32(self.along[1])
        reach = float(np.abs(self.along) @ [width, height])
        edge = reach * (self.way[0] + (self.way[1] - self.way[0]) * frame / max(self.frames - 1, 1))
        lit_side = np.clip(((u[None] + v[:, None]) - edge) / self.penumbra_px + 0.5, 0, 1)
        return ground_e * (0.5 + 0.5 * lit_side)


class LightDrift(Disturbance):
    """The light drifts by 5 % over the sequence, steadily or to and fro."""

    def begin(self, stage: Stage, rng: np.random.Generator) -> None:
        progress = np.linspace(0, 1, len(stage.leds))
        waves = 2 * np.pi * rng.uniform(0.5, 3.0) * progress
        shape = progress if rng.random() < 0.5 else 0.5 * np.sin(waves + rng.uniform(0, 2 * np.pi))
        self.level = 1 + 0.05 * rng.choice([-1, 1]) * shape

    def light(self, camera: int, frame: int, ground_e: np.ndarray) -> np.ndarray:
        return ground_e * np.float32(self.level[frame])


# -- cameras


class HeadVibration(Disturbance):
    """Every frame of both cameras off by up to 3 px, 1 px rms in each axis."""

    def begin(self, stage: Stage, rng: np.random.Generator) -> None:
        off = rng.standard_normal((len(stage.leds), 2))
        self.off_px = off * np.minimum(
            1.0, 3.0 / np.maximum(np.linalg.norm(off, axis=1, keepdims=True), 1e-9)
        )

    def shift_px(self, frame: int) -> tuple[float, float]:
        du, dv = self.off_px[frame].tolist()
        return du, dv


class HotPixels(Disturbance):
    """0.1 to 0.5 % of the pixels hot, dead, or flickering (a tenth of them), the same in every frame."""

    def begin(self, stage: Stage, rng: np.random.Generator) -> None:
        share = rng.uniform(0.001, 0.005)
        kinds = [0.45 * share, 0.45 * share, 0.1 * share]
        edges = np.cumsum(kinds)
        self.kind = [np.searchsorted(edges, rng.random((w.height, w.width))) for w in stage.windows]
        self.rng = rng

    def delivered(self, camera: int, first: int, counts: np.ndarray) -> np.ndarray:
        kind = self.kind[camera]
        counts[:, kind == 0], counts[:, kind == 1] = FULL, 0
        flickers = kind == 2
        raised = self.rng.random((len(counts), int(flickers.sum()))) < 0.5
        counts[:, flickers] = np.minimum(counts[:, flickers] + np.uint16(60) * raised, FULL)
        return counts


class ImageBlur(Disturbance):
    """Dust: the point spread up to twice as wide, contrast down by up to 30 %."""

    def begin(self, stage: Stage, rng: np.random.Generator) -> None:
        self.psf_scale, self.contrast = rng.uniform(1.3, 2.0), rng.uniform(0.7, 0.9)

    def ground(self, camera: int, ground_e: np.ndarray) -> np.ndarray:
        blurred = cv2.GaussianBlur(ground_e, (0, 0), 0.5 * np.sqrt(self.psf_scale**2 - 1))
        mean = np.float32(ground_e.mean())
        return mean + np.float32(self.contrast) * (blurred - mean)


class CameraDead(Disturbance):
    """One camera shows black, a count or two of noise, or the same frame for ever."""

    def begin(self, stage: Stage, rng: np.random.Generator) -> None:
        self.dead, self.how, self.rng = int(rng.integers(2)), int(rng.integers(3)), rng
        self.stuck: np.ndarray | None = None

    def delivered(self, camera: int, first: int, counts: np.ndarray) -> np.ndarray:
        if camera != self.dead:
            return counts
        if self.how == 0:
            return np.zeros_like(counts)
        if self.how == 1:
            return self.rng.integers(0, 3, counts.shape).astype(np.uint16)
        if self.stuck is None:
            self.stuck = counts[:1].copy()
        return np.repeat(self.stuck, len(counts), axis=0)


# -- frames


class FrozenFrames(Disturbance):
    """Every frame is the first one again, or 5 to 30 % of them repeat the one before."""

    def begin(self, stage: Stage, rng: np.random.Generator) -> None:
        frames = len(stage.leds)
        whole = rng.random() < 0.25
        self.frozen = np.ones(frames, bool) if whole else rng.random(frames) < rng.uniform(0.05, 0.3)
        if not self.frozen.any():
            self.frozen[rng.integers(1, frames)] = True
        self.last: dict[int, np.ndarray] = {}

    def delivered(self, camera: int, first: int, counts: np.ndarray) -> np.ndarray:
        for k in range(len(counts)):
            if self.frozen[first + k] and camera in self.last:
                counts[k] = self.last[camera]
            self.last[camera] = counts[k].copy()
        return counts


class LateFrames(Disturbance):
    """Each frame shows what was ordered for the one before, or the one after."""

    def begin(self, stage: Stage, rng: np.random.Generator) -> None:
        self.by = int(rng.choice([-1, 1]))

    def power(self, stage: Stage) -> np.ndarray:
        return np.roll(stage.ordered, self.by, axis=0)


class MissingFrames(Disturbance):
    """Some frames of one camera or both are lost: fewer come than were ordered, or they come as zeros."""

    def begin(self, stage: Stage, rng: np.random.Generator) -> None:
        self.short = rng.random() < 0.5
        self.cameras = [[0], [1], [0, 1]][rng.integers(3)]
        self.lost = rng.random(len(stage.leds)) < rng.uniform(0.0, 0.1)
        self.lost[rng.integers(len(stage.leds))] = True

    def delivered(self, camera: int, first: int, counts: np.ndarray) -> np.ndarray:
        lost = self.lost[first : first + len(counts)]
        if camera not in self.cameras:
            return counts
        if self.short:
            return counts[~lost]
        counts[lost] = 0
        return counts


class SwappedFrames(Disturbance):
    """One to three couples of neighbouring frames come in the other's place."""

    def begin(self, stage: Stage, rng: np.random.Generator) -> None:
        self.order = np.arange(len(stage.leds))
        for k in rng.integers(0, len(stage.leds) - 1, rng.integers(1, 4)):
            self.order[[k, k + 1]] = self.order[[k + 1, k]]

    def power(self, stage: Stage) -> np.ndarray:
        return stage.ordered[self.order]


class SwappedCameras(Disturbance):
    """The cables are swapped: each camera's window is read out of the other."""

    @property
    def crossed(self) -> bool:
        return True


# -- what is right to say

FAINT = r"joint SNR|markers? seen|of \d markers shine|explains .* markers seen|two poses explain"
UNLIKE = r"unexplained difference|brightness change|change of contrast|px of shift|pull the markers apart"
IMPLAUSIBLE = r"no pose explains|not shine alike|two poses explain|pull the markers|from the prediction"


@dataclass(frozen=True)
class Case:
    """A disturbance of the matrix and the reasons that are right for it."""

    make: Callable[[], Disturbance]
    right: str

    def says(self, why: str) -> bool:
        """Whether a refusal names what is wrong, or the truth."""
        return re.search(self.right, why) is not None


def _or(*reasons: str) -> str:
    return "|".join(reasons)


MATRIX: dict[str, Case] = {
    "led_off": Case(LedOff, FAINT),
    "led_dim": Case(LedDim, FAINT),
    "led_stuck_on": Case(LedStuckOn, FAINT),
    "led_swapped": Case(LedSwapped, _or(FAINT, IMPLAUSIBLE)),
    "false_reflection": Case(FalseReflection, IMPLAUSIBLE),
    "glare": Case(Glare, _or("saturated", FAINT)),
    "moving_shadow": Case(MovingShadow, _or(UNLIKE, FAINT)),
    "light_drift": Case(LightDrift, UNLIKE),
    "head_vibration": Case(HeadVibration, UNLIKE),
    "hot_pixels": Case(HotPixels, _or("pixels", FAINT)),
    "image_blur": Case(ImageBlur, FAINT),
    "frozen_frames": Case(FrozenFrames, _or("repeat", FAINT)),
    "late_frames": Case(LateFrames, _or("late", "code", IMPLAUSIBLE, FAINT)),
    "missing_frames": Case(MissingFrames, _or("got frames of shape", "black", UNLIKE)),
    "swapped_frames": Case(SwappedFrames, _or("code", IMPLAUSIBLE, FAINT)),
    "swapped_cameras": Case(SwappedCameras, _or(IMPLAUSIBLE, FAINT)),
    "camera_dead": Case(CameraDead, _or("camera: (black|repeat)", "camera alone", FAINT)),
}
