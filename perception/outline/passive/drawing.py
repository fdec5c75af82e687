"""The rover drawn for several poses at once: how much of each pixel shows which of its shades, or its shadow.

Facets that face the camera are covered exactly (outline.passive.coverage), solids hide one another from
near to far, the shadow is what facets that face the sun cast on the plane that the rover stands on. All of it
is blurred as the optics do.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from executive.core.types import Array, Vec2, Window
from perception.frames.psf import marker_spread
from perception.geometry.chain import Chain
from perception.outline.passive.coverage import Layers, coverage
from perception.outline.passive.hiding import near_first
from perception.outline.passive.solids import Indices, Solids

_LOWEST_SINE = 0.05  # of the sun's height over the plane, for a shadow of finite length


@dataclass(frozen=True, eq=False)
class Stands:
    """Poses (n) to draw: body in site (n, 3, 3) and (n, 3) [m], sun as azimuth and elevation (n, 2) [rad]."""

    rotation: Array
    position_m: Array
    sun_rad: Array

    @property
    def toward_sun(self) -> Array:
        """Unit vectors (n, 3) towards the sun in site."""
        azimuth, elevation = self.sun_rad.T
        level = np.cos(elevation)
        return np.stack([level * np.cos(azimuth), level * np.sin(azimuth), np.sin(elevation)], axis=-1)


@dataclass(frozen=True, eq=False)
class Drawing:
    """One camera's picture in shares: `shades` (n, s, h, w) of the rover's, `ground` (n, h, w) not hidden by
    it, `shadow` (n, h, w) the part of that in its shadow."""

    shades: Layers
    ground: Layers
    shadow: Layers


@dataclass(frozen=True, eq=False)
class _Seen:
    """Facets as outlines: segments in pixels of the window with the layer of each."""

    start: Array
    end: Array
    layer: Indices


class Artist:
    """Draws one rover (solids at given joints) from one head pose into one window of one camera."""

    def __init__(self, chain: Chain, solids: Solids, head_rad: Vec2, camera: int, window: Window) -> None:
        self._chain, self._solids, self._head_rad, self._camera = chain, solids, head_rad, camera
        self.window, self._model = window, chain.model.camera(camera)
        self._head = chain.site_ih(head_rad)
        self._eye = self._head.apply(chain.model.position_ih_m[camera][None])[0]
        self._order: tuple[int, ...] = ()

    def framing(self, stands: Stands, margin_px: int) -> Artist:
        """One who draws no more of this window than rover and shadow at these poses take."""
        fallen, _ = self._fallen(stands)
        outline = np.concatenate([self._placed(self._solids.vertices_m, stands), fallen], axis=1)
        uv = self.pixels_of(outline).reshape(-1, 2)
        size = np.array([self.window.width, self.window.height])
        low = np.clip(np.floor(uv.min(axis=0)) - margin_px, 0, size - 1).astype(int)
        high = np.clip(np.ceil(uv.max(axis=0)) + margin_px, low + 1, size).astype(int)
        corner = (self.window.u + int(low[0]), self.window.v + int(low[1]))
        window = Window(*corner, int(high[0] - low[0]), int(high[1] - low[1]))
        return Artist(self._chain, self._solids, self._head_rad, self._camera, window)

    def draw(self, stands: Stands) -> Drawing:
        """The rover at these poses; shades that none of them shows are left out."""
        range_m = float(np.linalg.norm(stands.position_m[0] - self._eye))
        shares, shade_solid = self._facets(stands)
        clear = np.ones((len(shares), *shares.shape[2:]), np.float32)
        for solid in self._near_first(stands):
            own = shade_solid == solid
            hidden = 1 - shares[:, own].sum(axis=1)
            shares[:, own] *= clear[:, None]
            clear *= np.clip(hidden, 0, 1)
        shadow = self._shadow(stands) * clear
        sigma_px = marker_spread(self._chain.rig, range_m).sigma_px
        shades, dark = _blurred(shares, sigma_px), _blurred(shadow, sigma_px)
        return Drawing(shades, 1 - shades.sum(axis=1), dark)

    def pixels_of(self, points_site_m: Array) -> Array:
        """Window coordinates (..., 2) of points (..., 3) in site [px]; pixels end at whole ones."""
        flat = self._head.inverse().apply(points_site_m.reshape(-1, 3))
        uv = self._model.project(flat)[0] - (self.window.u - 0.5, self.window.v - 0.5)
        return np.asarray(np.nan_to_num(uv).reshape((*points_site_m.shape[:-1], 2)))

    def _near_first(self, stands: Stands) -> tuple[int, ...]:
        """The order in which solids hide one another, as the first pose ever drawn shows them."""
        if not self._order:
            eye = stands.rotation[0].T @ (self._eye - stands.position_m[0])
            self._order = near_first(self._solids, eye)
        return self._order

    def _facets(self, stands: Stands) -> tuple[Layers, Indices]:
        """Shares (n, s, h, w) of the shades that show, none hidden yet, and the solids that bear them."""
        solids = self._solids
        point = self._placed(solids.point_m, stands)
        normal = solids.normal @ stands.rotation.transpose(0, 2, 1)
        faces = ((self._eye - point) * normal).sum(axis=-1) > 0
        shown = np.unique(solids.shade[faces.any(axis=0)])
        layer_of = np.full(len(solids.shade_solid), -1)
        layer_of[shown] = np.arange(len(shown))
        uv = self.pixels_of(self._placed(solids.vertices_m, stands))
        seen = self._outlines(uv, faces, layer_of[solids.shade], len(shown))
        shares = self._covered(seen, len(faces), len(shown))
        for shade, base in zip(layer_of, solids.shade_over, strict=True):
            if shade >= 0 and base >= 0:
                shares[:, layer_of[base]] -= shares[:, shade]
        return shares, solids.shade_solid[shown]

    def _shadow(self, stands: Stands) -> Layers:
        """Shares (n, h, w) of the plane under the rover that it keeps the sun off."""
        solids = self._solids
        fallen, toward = self._fallen(stands)
        lit = (solids.normal @ stands.rotation.transpose(0, 2, 1) @ toward[..., None])[..., 0] > 0
        lit &= solids.over < 0
        count = int(solids.solid.max()) + 1
        seen = self._outlines(self.pixels_of(fallen), lit, solids.solid, count)
        shares = self._covered(seen, len(lit), count)
        dark: Layers = 1 - np.prod(1 - np.clip(shares, 0, 1), axis=1)
        return dark

    def _fallen(self, stands: Stands) -> tuple[Array, Array]:
        """Where vertices (n, v, 3) throw their shadows, and the unit vectors (n, 3) towards the sun."""
        toward, up = stands.toward_sun, stands.rotation[:, :, 2]
        sine = np.maximum((toward * up).sum(axis=-1), _LOWEST_SINE)
        points = self._placed(self._solids.vertices_m, stands)
        height = ((points - stands.position_m[:, None]) * up[:, None]).sum(axis=-1)
        fallen = points - (np.maximum(height, 0) / sine[:, None])[..., None] * toward[:, None]
        return fallen, toward

    def _placed(self, points_m: Array, stands: Stands) -> Array:
        placed: Array = points_m @ stands.rotation.transpose(0, 2, 1) + stands.position_m[:, None]
        return placed

    def _outlines(self, uv: Array, facets: NDArray[np.bool_], layer: Indices, layers: int) -> _Seen:
        """The edges of the facets chosen (n, f), each in the layer of its facet (f,)."""
        solids = self._solids
        stand, edge = np.nonzero(facets[:, solids.edge_facet])
        ends = solids.edges[edge]
        where = stand * layers + layer[solids.edge_facet[edge]]
        return _Seen(uv[stand, ends[:, 0]], uv[stand, ends[:, 1]], where)

    def _covered(self, seen: _Seen, stands: int, layers: int) -> Layers:
        size = (self.window.height, self.window.width)
        flat = coverage(seen.start, seen.end, seen.layer, (stands * layers, *size))
        return flat.reshape(stands, layers, *size)


def _blurred(layers: Layers, sigma_px: float) -> Layers:
    """Layers (..., h, w) blurred by a Gaussian; nothing lies beyond their edges."""
    reach = min(math.ceil(3 * sigma_px), *(n - 1 for n in layers.shape[-2:]))
    kernel = np.exp(-0.5 * (np.arange(reach + 1) / sigma_px) ** 2).astype(np.float32)
    kernel /= 2 * kernel.sum() - kernel[0]
    for axis in (-1, -2):
        turned = np.moveaxis(layers, axis, -1)
        out = turned * kernel[0]
        for step, weight in enumerate(kernel[1:], 1):
            out[..., step:] += weight * turned[..., :-step]
            out[..., :-step] += weight * turned[..., step:]
        layers = np.moveaxis(out, -1, axis)
    return layers
