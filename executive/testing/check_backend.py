"""What every backend must keep, as one function that names each breach."""

from __future__ import annotations

import math
from collections.abc import Callable

from executive.config.backends import BackendRequest, BackendSpec
from executive.core.devices import CABIN, CAMERAS, DRIVE, HEAD
from executive.core.errors import Breach
from executive.core.ports import Action, Backend
from executive.core.rig import RigCalibration
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
    if not isinstance(request.rig, spec.rig):
        raise BackendBreach(subject, [f"its rig is a {spec.rig.__name__}"])
    broken: list[str] = []

    def make() -> Backend:
        return spec.create(request)

    try:
        _the_devices_are_those_declared(make, spec)
    except _Broken as breach:  # all else would only say so once more
        raise BackendBreach(subject, [str(breach)]) from None
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
        _readings_are_numbers,
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
        drive, before = backend.devices[DRIVE], backend.devices[DRIVE].read()
        left_m = _in_s(backend, 14.0)
        outcome = _until_done(backend, drive.drive(left_m, left_m / 2, backend.rig.rover.speed_m_s))
        after = drive.read()
        off_m = (after.left_m - before.left_m - left_m, after.right_m - before.right_m - left_m / 2)
        _expect(outcome.reason is Reason.DONE, f"a free drive ends DONE, got {outcome}")
        _expect(abs(off_m[0]) < 0.05 * left_m, "the left encoder shows the travel asked")
        _expect(abs(off_m[1]) < 0.05 * left_m, "the right encoder shows the travel asked")
        _expect(not after.moving, "the drive rests after a drive")
        _expect(outcome.value is not None, "a drive returns what was driven")

    _with(make, body)


def _a_cancelled_drive_rests(make: Make) -> None:
    def body(backend: Backend) -> None:
        action = backend.devices[DRIVE].drive(
            _in_s(backend, 70.0), _in_s(backend, 70.0), backend.rig.rover.speed_m_s
        )
        backend.advance()
        backend.advance()
        action.cancel()
        backend.devices[DRIVE].stop()
        _expect(_until_done(backend, action).reason is Reason.CANCELLED, "a cancelled drive says so")
        backend.advance()
        first = backend.devices[DRIVE].read()
        backend.advance()
        second = backend.devices[DRIVE].read()
        _expect(abs(first.left_m - second.left_m) < _in_s(backend, 0.1), "a cancelled drive rests")

    _with(make, body)


def _a_new_drive_replaces_the_old(make: Make) -> None:
    def body(backend: Backend) -> None:
        first = backend.devices[DRIVE].drive(
            _in_s(backend, 70.0), _in_s(backend, 70.0), backend.rig.rover.speed_m_s
        )
        backend.advance()
        second = backend.devices[DRIVE].drive(
            _in_s(backend, 4.0), _in_s(backend, 4.0), backend.rig.rover.speed_m_s
        )
        _expect(_until_done(backend, first).reason is Reason.CANCELLED, "a replaced drive ends CANCELLED")
        _expect(_until_done(backend, second).reason is Reason.DONE, "the replacing drive ends DONE")

    _with(make, body)


def _safe_stop_rests_and_repeats(make: Make) -> None:
    def body(backend: Backend) -> None:
        backend.devices[DRIVE].drive(_in_s(backend, 70.0), _in_s(backend, 70.0), backend.rig.rover.speed_m_s)
        backend.advance()
        backend.safe_stop()
        backend.safe_stop()
        backend.advance()
        _expect(not backend.devices[DRIVE].read().moving, "safe_stop() brings the drive to rest")

    _with(make, body)


def _limits_are_refused_at_once(make: Make) -> None:
    def body(backend: Backend) -> None:
        if (head := backend.devices.get(HEAD)) is not None:
            refused = head.point(0.0, math.radians(400.0)).poll()
            refuses = refused is not None and refused.reason is Reason.OUT_OF_REACH
            _expect(refuses, "the head refuses what is beyond its limits")
        if (cabin := backend.devices.get(CABIN)) is not None:
            refused_too = cabin.move(math.radians(400.0), 0.0).poll()
            refuses = refused_too is not None and refused_too.reason is Reason.OUT_OF_REACH
            _expect(refuses, "the cabin refuses what is beyond its limits")

    _with(make, body)


def _the_head_arrives(make: Make) -> None:
    def body(backend: Backend) -> None:
        if (head := backend.devices.get(HEAD)) is None:
            return
        outcome = _until_done(backend, head.point(0.1, 0.3))
        reading = head.read()
        off = math.hypot(reading.pan_rad - 0.1, reading.tilt_rad - 0.3)
        _expect(outcome.ok and off < math.radians(0.1), "the head arrives where it was pointed")

    _with(make, body)


def _the_cabin_arrives(make: Make) -> None:
    def body(backend: Backend) -> None:
        if (cabin := backend.devices.get(CABIN)) is None:
            return
        outcome = _until_done(backend, cabin.move(0.2, -0.1))
        reading = cabin.read()
        off = math.hypot(reading.arm_rad - 0.2, reading.cabin_rad + 0.1)
        _expect(outcome.ok and off < math.radians(1.0), "the cabin arrives where it was sent")

    _with(make, body)


def _cameras_answer_what_was_asked(make: Make) -> None:
    def body(backend: Backend) -> None:
        if (cameras := backend.devices.get(CAMERAS)) is None:
            return
        windows = (Window(100, 200, 64, 48), Window(120, 210, 64, 48))
        shot = Shot(leds=(0, 1, 2), windows=windows)
        outcome = _until_done(backend, cameras.take(shot))
        _expect(outcome.ok, f"the cameras answer, got {outcome.reason}")
        taken = outcome.value
        _expect(isinstance(taken, Images | Centres), "the cameras answer with images or centres")
        if isinstance(taken, Images):
            shapes = tuple(c.shape for c in taken.counts)
            _expect(shapes == ((3, 48, 64), (3, 48, 64)), f"stacks are (frames, height, width), got {shapes}")
            if isinstance(backend.rig, RigCalibration):
                top = 2**backend.rig.sensor.bits
                _expect(all(int(c.max()) < top for c in taken.counts), "counts stay below 2**bits")
        elif isinstance(taken, Centres):
            _expect(taken.uv_px.shape == (2, 4, 2), f"centres are (2, 4, 2), got {taken.uv_px.shape}")

    _with(make, body)


def _readings_carry_the_time(make: Make) -> None:
    def body(backend: Backend) -> None:
        for _ in range(3):
            backend.advance()
        for spec, device in ((one.spec, one.device) for one in backend.devices if one.spec.quantities):
            seen = getattr(spec.read(device), "time_s", backend.clock.now_s)
            _expect(seen == backend.clock.now_s, f"{spec.name} reads at the clock's time, got {seen}")

    _with(make, body)


def _readings_are_numbers(make: Make) -> None:
    def body(backend: Backend) -> None:
        for one in backend.devices:
            for name, value in one.spec.sample(one.device).items():
                _expect(math.isfinite(value), f"{one.spec.name} reports {name} as a number, got {value}")

    _with(make, body)


def _the_same_seed_repeats(make: Make) -> None:
    def drive() -> dict[str, dict[str, float]]:
        backend = make()
        try:
            way_m, speed_m_s = _in_s(backend, 7.0), backend.rig.rover.speed_m_s
            _until_done(backend, backend.devices[DRIVE].drive(way_m, 2 * way_m, speed_m_s))
            return {one.spec.name: one.spec.sample(one.device) for one in backend.devices}
        finally:
            backend.close()

    _expect(drive() == drive(), "the same request gives the same readings, bit for bit")


def _the_devices_are_those_declared(make: Make, spec: BackendSpec) -> None:
    def body(backend: Backend) -> None:
        there, declared = sorted(one.spec.name for one in backend.devices), sorted(spec.devices)
        _expect(there == declared, f"its devices are those that its spec names, {declared}, got {there}")
        _expect(backend.devices.get(DRIVE) is not None, "one of its devices serves as a drive")
        for one in backend.devices:
            lacking = [
                verb.name for verb in one.spec.verbs if not callable(getattr(one.device, verb.name, None))
            ]
            _expect(not lacking, f"{one.spec.name} can be told {', '.join(lacking)}")

    _with(make, body)


def _in_s(backend: Backend, time_s: float) -> float:
    """How far a belt goes in that time [m]."""
    return time_s * backend.rig.rover.speed_m_s
