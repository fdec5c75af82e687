"""Rocks in an image: spheres half buried, with a rough surface, and the shadow they cast on the ground."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from executive.core.types import Array, Window
from sim_pybullet.projection import PlacedCamera
from sim_pybullet.raycast import HeightField
from sim_pybullet.scene import Rock
from sim_pybullet.sunlight import SKYLIGHT, Sun

Image = NDArray[np.float32]

_ALBEDO = 0.82  # rock is darker than the dust around it
_ROUGHNESS = 0.28
_EDGE_PX = 0.8


def far_first(rocks: tuple[Rock, ...], from_site_m: Array) -> list[Rock]:
    """Rocks by falling distance."""
    return sorted(
        rocks, key=lambda rock: -float(np.linalg.norm(np.asarray(rock.centre_site_m) - from_site_m))
    )


def draw_rock(
    image: Image, range_m: Image, rock: Rock, field: HeightField, sun: Sun, view: PlacedCamera, window: Window
) -> None:
    """Paint one rock over the image (h, w), in place; ground in front, by its range (h, w), hides it."""
    area = pixel_area(np.array([rock.centre_site_m]), rock.radius_m, view, window)
    if area is None:
        return
    rows, columns = area
    u, v = np.meshgrid(columns.astype(np.float64), rows.astype(np.float64))
    rays = view.rays(u, v)
    rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
    to_centre = np.asarray(rock.centre_site_m) - view.position_site_m
    along = rays @ to_centre
    miss_m = np.sqrt(np.maximum(to_centre @ to_centre - along**2, 0.0))
    pixel_m = float(np.linalg.norm(to_centre)) / view.camera.focal_px
    cover = np.clip(0.5 + (rock.radius_m - miss_m) / (pixel_m * _EDGE_PX), 0, 1)
    half_chord = np.sqrt(np.maximum(rock.radius_m**2 - miss_m**2, 0.0))
    surface = (along - half_chord)[..., None] * rays - to_centre
    normals = surface / np.maximum(np.linalg.norm(surface, axis=-1, keepdims=True), 1e-9)
    normals = _roughened(normals, rock, pixel_m)
    light = _ALBEDO * sun.irradiance(normals)
    # Dust gathers at the foot and the sky is hidden there.
    height = (surface[..., 2] / rock.radius_m + 1) / 2
    light *= np.clip(0.55 + 0.7 * height, 0.5, 1.0)
    where = np.ix_(rows - window.v, columns - window.u)
    seen = view.position_site_m + surface + to_centre
    ground_m = field.height(seen[..., 0].astype(np.float32), seen[..., 1].astype(np.float32))
    cover *= np.clip(0.5 + (seen[..., 2] - ground_m) / (0.06 * rock.radius_m), 0, 1)
    cover *= range_m[where] > along - half_chord - 2 * rock.radius_m
    image[where] = image[where] * (1 - cover) + light * cover


def _roughened(normals: Array, rock: Rock, pixel_m: float) -> Array:
    """Normals bent by a few fixed waves over the sphere, so that no rock looks turned on a lathe."""
    seed = np.array(rock.centre_site_m) * 37.0
    bent = normals.copy()
    for octave, (frequency, share) in enumerate(((2.3, 1.0), (5.1, 0.8), (11.0, 0.6), (23.0, 0.5))):
        if pixel_m > 0.5 * rock.radius_m / frequency:
            break
        phase = seed[[octave % 3, (octave + 1) % 3, (octave + 2) % 3]]
        warped = normals + 0.35 * np.sin(2.1 * normals[..., [1, 2, 0]] * frequency**0.5 + phase)
        bent += _ROUGHNESS * share * np.sin(frequency * warped[..., [2, 0, 1]] + phase)
    return np.asarray(bent / np.linalg.norm(bent, axis=-1, keepdims=True))


def shade_by_rocks(
    image: Image,
    x_m: Image,
    y_m: Image,
    z_m: Image,
    rocks: tuple[Rock, ...],
    sun: Sun,
    view: PlacedCamera,
    window: Window,
    samples: int,
) -> None:
    """Darken ground points whose ray to the sun meets a rock, in place. Rows are sampled `samples` times."""
    toward = sun.direction_site
    for rock in rocks:
        centre = np.asarray(rock.centre_site_m)
        tip = centre - toward * (2 * rock.radius_m / math.sin(sun.height_rad))
        area = pixel_area(np.stack([centre, tip]), 1.1 * rock.radius_m, view, window)
        if area is None:
            continue
        rows, columns = area
        part = np.s_[
            (rows[0] - window.v) * samples : (rows[-1] + 1 - window.v) * samples,
            columns[0] - window.u : columns[-1] + 1 - window.u,
        ]
        image[part] *= _sunlit_beside(x_m[part], y_m[part], z_m[part], centre, rock.radius_m, toward)


def _sunlit_beside(
    x_m: Image, y_m: Image, z_m: Image, centre: Array, radius_m: float, toward: Array
) -> Image:
    """Light left at ground points beside a sphere: its cast shadow and the sky it hides near its foot."""
    dx, dy, dz = (np.float32(c) - p for c, p in zip(centre, (x_m, y_m, z_m), strict=True))
    along = dx * np.float32(toward[0]) + dy * np.float32(toward[1]) + dz * np.float32(toward[2])
    square = dx * dx + dy * dy + dz * dz
    miss = np.sqrt(np.maximum(square - along * along, 0))
    soft = np.maximum(np.float32(0.012) * along, np.float32(0.02 * radius_m))
    shadow = np.clip(0.5 + (radius_m - miss) / soft, 0, 1) * (along > -radius_m)
    near = np.clip(np.sqrt(square) / np.float32(radius_m) - 0.9, 0, 1)
    return np.asarray((1 - (1 - SKYLIGHT) * shadow) * (0.75 + 0.25 * near), dtype=np.float32)


def pixel_area(
    centres_site_m: Array, radius_m: float, view: PlacedCamera, window: Window
) -> tuple[NDArray[np.int64], NDArray[np.int64]] | None:
    """Rows and columns of the window that spheres of this radius about the points can touch; None if none."""
    uv, depth = view.project(centres_site_m)
    if not (depth > 2 * radius_m).all():
        return None
    reach = radius_m * view.camera.focal_px / (depth - radius_m)[:, None] * 1.05 + 2
    low = np.floor((uv - reach).min(axis=0)).astype(int)
    high = np.ceil((uv + reach).max(axis=0)).astype(int)
    columns = np.arange(max(low[0], window.u), min(high[0] + 1, window.u + window.width))
    rows = np.arange(max(low[1], window.v), min(high[1] + 1, window.v + window.height))
    if not len(rows) or not len(columns):
        return None
    return rows, columns
