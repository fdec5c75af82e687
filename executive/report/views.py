"""What the cameras saw at chosen localisations, with the detections drawn in."""

from __future__ import annotations

import base64
from html import escape
from typing import NamedTuple

import cv2
import numpy as np

from executive.record.events import AnnotationsEvent, ImageEvent
from executive.report import svg
from executive.report.axes import legend
from executive.report.figure import Figure, duration
from executive.report.gather import RecordedRun

_MOST = 4
_DETECTED, _REPROJECTED, _WINDOW = "#ffa033", "#46c8ff", "#7be0a0"


class View(NamedTuple):
    """One recorded picture with what was found in it."""

    time_s: float
    image: ImageEvent
    marks: AnnotationsEvent | None


def views(run: RecordedRun) -> Figure | None:
    """Pairs of pictures: up to four localisations, between the first and the last full frame."""
    found = _views(run)
    if not found:
        return None
    looks = sorted(t for t, pair in found.items() if any(view.marks for view in pair))
    frames = sorted(set(found) - set(looks))
    chosen = sorted([*frames[:1], *_chosen(run, looks or frames), *frames[1:][-1:]])
    pairs = "".join(_pair(time_s, found[time_s]) for time_s in chosen)
    entries = [
        ("ring", _DETECTED, "detected"),
        ("dot", _REPROJECTED, "reprojected from the pose"),
        ("dash", _WINDOW, "window read out"),
    ]
    caption = (
        f"{len(chosen)} of the {len(found)} pictures kept, left and right camera side by side, contrast "
        "stretched. Full frames are taken at way-points, read-out windows at localisations. A circle is a "
        "marker found in the difference images, a blue dot where the estimated pose would put it: the two "
        "should meet."
    )
    return Figure(
        "views", "Through the cameras", legend(entries) + f"<div class='views'>{pairs}</div>", caption
    )


def _views(run: RecordedRun) -> dict[float, list[View]]:
    """Pictures by time; the annotations of the same camera and time belong to them."""
    marks = {(at.time_s, at.event.camera): at.event for at in run.history.all(AnnotationsEvent)}
    found: dict[float, list[View]] = {}
    for time_s, image in run.history.all(ImageEvent):
        found.setdefault(time_s, []).append(View(time_s, image, marks.get((time_s, image.camera))))
    return found


def _chosen(run: RecordedRun, times: list[float]) -> list[float]:
    """First, last, those before a strategy was chosen, then evenly spread ones, in order of time."""
    wanted = [times[0], times[-1]]
    for row in run.result.strategies:
        before = [t for t in times if t <= row.t_s]
        wanted += before[-1:]
    spread = [times[round(i)] for i in np.linspace(0, len(times) - 1, _MOST)]
    return sorted(list(dict.fromkeys([*wanted, *spread]))[:_MOST])


def _pair(time_s: float, pictures: list[View]) -> str:
    shown = "".join(_picture(view) for view in sorted(pictures, key=lambda v: v.image.camera))
    said = next((v.marks.caption for v in pictures if v.marks and v.marks.caption), "")
    words = f"{duration(time_s)}{' · ' + escape(said) if said else ''}"
    return f"<div class='pair'><div class='two'>{shown}</div><p>{words}</p></div>"


def _picture(view: View) -> str:
    width, height = _size(view.image)
    u, v, w, h = _cut(view.marks, width, height)
    unit = w / 240  # one pixel on the page, in pixels of the picture
    data = base64.b64encode(view.image.data).decode()
    picture = svg.element(
        "image",
        href=f"data:image/{view.image.format};base64,{data}",
        width=width,
        height=height,
        class_="pixels",
    )
    label = svg.text(
        u + 6 * unit, v + 15 * unit, view.image.camera, fill="#fff", font_size=svg.number(11 * unit)
    )
    return svg.element(
        "svg",
        picture,
        _marks(view.marks, unit),
        label,
        viewBox=f"{u:.2f} {v:.2f} {w:.2f} {h:.2f}",
        role="img",
        aria_label=f"{view.image.camera} camera",
    )


def _size(image: ImageEvent) -> tuple[int, int]:
    """Width and height in pixels; 1, 1 for a picture that cannot be read."""
    decoded = cv2.imdecode(np.frombuffer(image.data, dtype=np.uint8), cv2.IMREAD_GRAYSCALE)
    return (1, 1) if decoded is None else (decoded.shape[1], decoded.shape[0])


def _cut(marks: AnnotationsEvent | None, width: int, height: int) -> tuple[float, float, float, float]:
    """The 4:3 part of the picture to show: the windows with some border, else the whole picture."""
    if marks is None or not marks.windows:
        return 0.0, 0.0, float(width), float(height)
    left, top = min(b.u for b in marks.windows), min(b.v for b in marks.windows)
    right = max(b.u + b.width for b in marks.windows)
    bottom = max(b.v + b.height for b in marks.windows)
    w = max(1.35 * (right - left), 1.35 * (bottom - top) * 4 / 3, 24.0)
    w = min(w, float(width), height * 4 / 3)
    u = min(max((left + right - w) / 2, 0.0), width - w)
    v = min(max((top + bottom - w * 0.75) / 2, 0.0), height - w * 0.75)
    return u, v, w, w * 0.75


def _marks(marks: AnnotationsEvent | None, unit: float) -> str:
    if marks is None:
        return ""
    body = [
        svg.element(
            "rect",
            x=b.u,
            y=b.v,
            width=b.width,
            height=b.height,
            fill="none",
            stroke=_WINDOW,
            stroke_width=svg.number(unit),
            stroke_dasharray=f"{svg.number(4 * unit)} {svg.number(3 * unit)}",
        )
        for b in marks.windows
    ]
    body += [
        svg.element(
            "circle",
            svg.title(f"marker {s.marker} detected at {s.u:.2f}, {s.v:.2f}"),
            cx=s.u + 0.5,
            cy=s.v + 0.5,
            r=svg.number(8 * unit),
            fill="none",
            stroke=_DETECTED,
            stroke_width=svg.number(1.6 * unit),
        )
        for s in marks.detected
    ]
    body += [
        svg.element("circle", cx=s.u + 0.5, cy=s.v + 0.5, r=svg.number(2.2 * unit), fill=_REPROJECTED)
        for s in marks.reprojected
    ]
    return "".join(body)
