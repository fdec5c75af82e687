"""What every backend must keep, as one function that names each breach."""

from __future__ import annotations

import math
from collections.abc import Callable

from executive.config.backends import BackendRequest, BackendSpec
from executive.core.errors import Breach
from executive.core.ports import Action, Backend
from executive.core.types import (
    Centres,
    Images,
    Outcome,
    Reason,
    Shot,
    Window,
)

Make = Callable[[], Backend]
PATIENCE_TICKS = 3000


class BackendBreach(Breach):
    """The backend breaks promises; the message says which."""


class _Broken(Exception):
    """One promise not kept."""


def check_backend(spec: BackendSpec, request: BackendRequest) -> None:
    """Run every check against fresh backends from this spec; BackendBreach with every promise not kept."""
    subject = f"backend {spec.name}"
    if request.tier not in spec.tiers:
        raise BackendBreach(subject, [f"got tier {request.tier}, {spec.name} offers {spec.tiers}"])
    broken: list[str] = []

    def make() -> Backend:
        return spec.create(request)

    for check in (
        _time_passes_by_whole_ticks,
        _a_drive_reaches_its_travel,
        _a_cancelled_drive_rests,
        _a_new_drive_replaces_the_old,
        _safe_stop_rests_and_repeats,
        _limits_are_refused_at_once,
        _the_head_arrives,
        _the_cabin_arrives,
        _cameras_answer_what_was_asked,
        _readings_carry_the_time,
        _the_same_seed_repeats,
    ):
        try:
            check(make)
        except _Broken as breach:
            broken.append(str(breach))
    if broken:
        raise BackendBreach(subject, broken)


def _with(make: Make, body: Callable[[Backend], None]) -> None:
    backend = make()
    try:
        body(backend)
    finally:
        backend.safe_stop()
        backend.close()
        backend.close()


def _expect(held: bool, promise: str) -> None:
    if not held:
        raise _Broken(promise)


def _until_done(backend: Backend, action: Action[object]) -> Outcome[object]:
    for _ in range(PATIENCE_TICKS):
        outcome = action.poll()
        if outcome is not None:
            _expect(action.poll() == outcome, "an outcome, once given, stays the same")
            return outcome
        backend.advance()
    raise _Broken(f"an action did not end within {PATIENCE_TICKS} ticks")


def _time_passes_by_whole_ticks(make: Make) -> None:
    def body(backend: Backend) -> None:
        for expected in range(4):
            _expect(backend.clock.ticks == expected, "advance() lets exactly one tick pass, from 0")
            backend.advance()

    _with(make, body)


def _a_drive_reaches_its_travel(make: Make) -> None:
    def body(backend: Backend) -> None:
        tracks, before = backend.devices.tracks, backend.devices.tracks.read()
        outcome = _until_done(backend, tracks.drive(0.02, 0.01, 0.0014))
        after = tracks.read()
        _expect(outcome.reason is Reason.DONE, f"a free drive ends DONE, got {outcome}")
        _expect(abs(after.left_m - before.left_m - 0.02) < 1e-3, "the left encoder shows the travel asked")
        _expect(abs(after.right_m - before.right_m - 0.01) < 1e-3, "the right encoder shows the travel asked")
        _expect(not after.moving, "the tracks rest after a drive")
        _expect(outcome.value is not None, "a drive returns what was driven")

    _with(make, body)


def _a_cancelled_drive_rests(make: Make) -> None:
    def body(backend: Backend) -> None:
        action = backend.devices.tracks.drive(0.1, 0.1, 0.0014)
        backend.advance()
        backend.advance()
        action.cancel()
        backend.devices.tracks.stop()
        _expect(_until_done(backend, action).reason is Reason.CANCELLED, "a cancelled drive says so")
        backend.advance()
        first = backend.devices.tracks.read()
        backend.advance()
        second = backend.devices.tracks.read()
        _expect(abs(first.left_m - second.left_m) < 1e-4, "a cancelled drive rests")

    _with(make, body)


def _a_new_drive_replaces_the_old(make: Make) -> None:
    def body(backend: Backend) -> None:
        first = backend.devices.tracks.drive(0.1, 0.1, 0.0014)
        backend.advance()
        second = backend.devices.tracks.drive(0.005, 0.005, 0.0014)
        _expect(_until_done(backend, first).reason is Reason.CANCELLED, "a replaced drive ends CANCELLED")
        _expect(_until_done(backend, second).reason is Reason.DONE, "the replacing drive ends DONE")

    _with(make, body)


def _safe_stop_rests_and_repeats(make: Make) -> None:
    def body(backend: Backend) -> None:
        backend.devices.tracks.drive(0.1, 0.1, 0.0014)
        backend.advance()
        backend.safe_stop()
        backend.safe_stop()
        backend.advance()
        _expect(not backend.devices.tracks.read().moving, "safe_stop() brings the tracks to rest")

    _with(make, body)


def _limits_are_refused_at_once(make: Make) -> None:
    def body(backend: Backend) -> None:
        beyond = backend.rig.head.tilt_limits_rad[1] + 1.0
        refused = backend.devices.head.point(0.0, beyond).poll()
        _expect(
            refused is not None and refused.reason is Reason.OUT_OF_REACH,
            "the head refuses its limits",
        )
        beyond = backend.rig.cabin.arm_limits_rad[1] + 1.0
        refused_too = backend.devices.cabin.move(beyond, 0.0).poll()
        _expect(
            refused_too is not None and refused_too.reason is Reason.OUT_OF_REACH,
            "the cabin refuses its limits",
        )

    _with(make, body)


def _the_head_arrives(make: Make) -> None:
    def body(backend: Backend) -> None:
        outcome = _until_done(backend, backend.devices.head.point(0.1, 0.3))
        reading = backend.devices.head.read()
        off = math.hypot(reading.pan_rad - 0.1, reading.tilt_rad - 0.3)
        _expect(outcome.ok and off < math.radians(0.1), "the head arrives where it was pointed")

    _with(make, body)


def _the_cabin_arrives(make: Make) -> None:
    def body(backend: Backend) -> None:
        outcome = _until_done(backend, backend.devices.cabin.move(0.2, -0.1))
        reading = backend.devices.cabin.read()
        off = math.hypot(reading.arm_rad - 0.2, reading.cabin_rad + 0.1)
        _expect(outcome.ok and off < math.radians(1.0), "the cabin arrives where it was sent")

    _with(make, body)


def _cameras_answer_what_was_asked(make: Make) -> None:
    def body(backend: Backend) -> None:
        windows = (Window(100, 200, 64, 48), Window(120, 210, 64, 48))
        shot = Shot(leds=(0, 1, 2), windows=windows)
        outcome = _until_done(backend, backend.devices.cameras.take(shot))
        _expect(outcome.ok, f"the cameras answer, got {outcome.reason}")
        taken = outcome.value
        _expect(isinstance(taken, Images | Centres), "the cameras answer with images or centres")
        if isinstance(taken, Images):
            shapes = tuple(c.shape for c in taken.counts)
            _expect(shapes == ((3, 48, 64), (3, 48, 64)), f"stacks are (frames, height, width), got {shapes}")
            top = 2**backend.rig.sensor.bits
            _expect(all(int(c.max()) < top for c in taken.counts), "counts stay below 2**bits")
        elif isinstance(taken, Centres):
            _expect(taken.uv_px.shape == (2, 4, 2), f"centres are (2, 4, 2), got {taken.uv_px.shape}")

    _with(make, body)


def _readings_carry_the_time(make: Make) -> None:
    def body(backend: Backend) -> None:
        for _ in range(3):
            backend.advance()
        devices = backend.devices
        for device in (devices.tracks, devices.cabin, devices.head, devices.inclinometer, devices.tether):
            seen = device.read().time_s
            _expect(
                seen == backend.clock.now_s, f"{type(device).__name__} reads at the clock's time, got {seen}"
            )

    _with(make, body)


def _the_same_seed_repeats(make: Make) -> None:
    def drive() -> tuple[object, ...]:
        backend = make()
        try:
            _until_done(backend, backend.devices.tracks.drive(0.01, 0.02, 0.0014))
            devices = backend.devices
            return devices.tracks.read(), devices.inclinometer.read(), devices.tether.read()
        finally:
            backend.close()

    _expect(drive() == drive(), "the same request gives the same readings, bit for bit")
