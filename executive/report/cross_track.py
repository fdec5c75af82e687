"""Cross-track error over mission time, with both margins and every localisation."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from executive.core.types import Array, PoseEstimate, Segment
from executive.record.events import SegmentEvent
from executive.report import palette, svg
from executive.report.axes import Chart, Scale, legend, time_axis, timed
from executive.report.figure import Figure
from executive.report.gather import RecordedRun

_WIDTH, _LEFT, _TOP, _HEIGHT = 1100.0, 200.0, 34.0, 250.0
_MM = 1000.0


def cross_track_figure(run: RecordedRun) -> Figure | None:
    """The chart, None where no segment was ever under way."""
    spans = list(segment_spans(run))
    if not spans:
        return None
    limit = _limit_mm(run, [s for _, _, s in spans])
    time = Scale(0.0, run.end_s, _LEFT, _WIDTH - 8)
    chart = Chart(time, Scale(-limit, limit, _TOP + _HEIGHT, _TOP))
    widest = max(s.off_track_m for _, _, s in spans) * _MM
    body = [
        _margins(chart, spans, limit),
        time_axis(time, _TOP, _TOP + _HEIGHT),
        chart.frame("left of the path [mm]"),
    ]
    body += [_believed(run, chart), _fixes(run, chart)]
    if run.cross is not None:
        body.append(
            chart.line(run.cross.time_s, run.cross.cross_m * _MM, stroke=palette.TRUTH, stroke_width=1.7)
        )
    drawn = svg.drawing(
        _WIDTH, _TOP + _HEIGHT + 26, body, aria_label="Cross-track error", **timed(time, _TOP, _TOP + _HEIGHT)
    )
    beyond = f" The off-track margin, ±{widest:.0f} mm, lies outside." if widest > limit else ""
    caption = (
        "How far the rover was to the left (+) or right (−) of the line it was meant to follow. Within the "
        "green band it drives straight on; in the amber band it corrects; beyond, it must stop. Orange: what "
        f"each localisation found, with ±2σ.{beyond} Vertical lines separate the segments."
    )
    return Figure("cross", "Cross-track error", legend(_legend(run)) + drawn, caption)


def segment_spans(run: RecordedRun) -> Iterator[tuple[float, float, Segment]]:
    """(from, to, segment) for every stretch of mission time with a segment under way."""
    events = run.history.all(SegmentEvent)
    ends = [at.time_s for at in events[1:]] + [run.end_s]
    for at, end in zip(events, ends, strict=False):
        if at.event.segment is not None:
            yield at.time_s, end, at.event.segment


def _legend(run: RecordedRun) -> list[tuple[str, str, str]]:
    entries = [
        ("area", palette.ON_TRACK, "on track"),
        ("area", palette.OFF_TRACK, "correcting"),
        ("dash", palette.ESTIMATE, "believed"),
        ("dot", palette.FIX, "localisation ±2σ"),
    ]
    return [("line", palette.TRUTH, "true"), *entries] if run.track is not None else entries


def _limit_mm(run: RecordedRun, segments: list[Segment]) -> float:
    """Half the height of the chart: the on-track margin, all that was driven, a near off-track margin."""
    seen = [abs(p.track.cross_m) for p in run.estimates if p.track is not None]
    if run.cross is not None and np.isfinite(run.cross.cross_m).any():
        seen.append(float(np.nanmax(np.abs(run.cross.cross_m))))
    needed = max([1.5 * max(s.on_track_m for s in segments), *(1.15 * v for v in seen)])
    widest = max(s.off_track_m for s in segments)
    return (1.08 * widest if widest < 5 * needed else needed) * _MM


def _margins(chart: Chart, spans: list[tuple[float, float, Segment]], limit: float) -> str:
    body = []
    for start, end, segment in spans:
        on, off = segment.on_track_m * _MM, segment.off_track_m * _MM
        body.append(chart.band(start, end, -off, off, fill=palette.OFF_TRACK, fill_opacity=0.16))
        body.append(chart.band(start, end, -on, on, fill=palette.ON_TRACK, fill_opacity=0.22))
        for edge in (-off, off):
            if abs(edge) <= limit:
                y = chart.value(edge)
                body.append(svg.line(chart.time(start), y, chart.time(end), y, stroke=palette.OFF_TRACK))
        x = chart.time(start)
        body.append(
            svg.line(x, chart.value.end, x, chart.value.start, stroke=palette.MUTED, stroke_width=0.8)
        )
        words = (
            f"to way-point {segment.index + 1}"
            if end - start > 0.12 * chart.time.high
            else f"{segment.index + 1}"
        )
        body.append(svg.text(x + 4, chart.value.end + 26, words, class_="tick"))
    return "".join(body)


def _believed(run: RecordedRun, chart: Chart) -> str:
    known = [(p.time_s, p.track.cross_m * _MM) for p in run.estimates if p.track is not None]
    if not known:
        return ""
    times, cross = np.array(known).T
    return chart.line(times, cross, stroke=palette.ESTIMATE, stroke_width=1.2, stroke_dasharray="4 2.5")


def _fixes(run: RecordedRun, chart: Chart) -> str:
    body = []
    for pose in run.fixes:
        if pose.track is None:
            continue
        cross, spread = pose.track.cross_m * _MM, 2 * _cross_sigma_m(run, pose) * _MM
        x = chart.time(pose.time_s)
        body.append(
            svg.element(
                "g",
                svg.title(f"{pose.time_s:.0f} s: {cross:+.1f} mm ± {spread:.1f} mm"),
                svg.line(
                    x,
                    chart.value.clamp(cross - spread),
                    x,
                    chart.value.clamp(cross + spread),
                    stroke=palette.FIX,
                    stroke_width=1.4,
                ),
                svg.element("circle", cx=x, cy=chart.value.clamp(cross), r=2.6, fill=palette.FIX),
            )
        )
    return "".join(body)


def _cross_sigma_m(run: RecordedRun, pose: PoseEstimate) -> float:
    """Standard deviation across the segment under way at the time of the pose [m]."""
    segment = next((s for start, end, s in segment_spans(run) if start <= pose.time_s <= end), None)
    if segment is None:
        return pose.sigma_position_m
    normal: Array = np.array([-math.sin(segment.bearing_rad), math.cos(segment.bearing_rad)])
    return math.sqrt(max(float(normal @ pose.covariance[:2, :2] @ normal), 0.0))
