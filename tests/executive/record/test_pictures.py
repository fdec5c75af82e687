import cv2
import numpy as np
import pytest

from executive.core.types import Window
from executive.record.pictures import annotated, picture


def decoded(event):
    return cv2.imdecode(np.frombuffer(event.data, np.uint8), cv2.IMREAD_GRAYSCALE)


def spot_image(height: int, width: int, u: float, v: float, sigma: float = 3.0):
    rows, columns = np.mgrid[0:height, 0:width]
    spot = 600 * np.exp(-((columns - u) ** 2 + (rows - v) ** 2) / (2 * sigma**2))
    return (100 + spot).astype(np.uint16)


def test_picture_is_no_longer_than_asked_and_keeps_its_proportions():
    event, scale = picture(spot_image(600, 900, 10, 10), "left", 300)
    assert decoded(event).shape == (200, 300)
    assert scale == pytest.approx(1 / 3)


def test_small_exposure_keeps_its_size():
    event, scale = picture(spot_image(40, 60, 30, 20), "right")
    assert decoded(event).shape == (40, 60)
    assert scale == 1.0


def test_flat_exposure_does_not_divide_by_nothing():
    event, _ = picture(np.full((20, 20), 140, np.uint16), "left")
    assert decoded(event).max() == 0


@pytest.mark.parametrize("longest", [512, 100])
def test_marks_lie_where_the_marker_is_in_the_picture(longest):
    shown = Window(300, 200, 400, 300)
    counts = spot_image(300, 400, 123.0, 87.0)
    image, marks = annotated(
        counts,
        shown,
        "left",
        {2: (423.0, 287.0), 3: (np.nan, np.nan)},
        {},
        [Window(400, 250, 60, 80)],
        "",
        longest,
    )
    found = decoded(image).astype(float)
    found[found < 60] = 0
    rows, columns = np.mgrid[0 : found.shape[0], 0 : found.shape[1]]
    (spot,) = marks.detected
    assert spot.marker == 2
    assert spot.u == pytest.approx((columns * found).sum() / found.sum(), abs=0.15)
    assert spot.v == pytest.approx((rows * found).sum() / found.sum(), abs=0.15)
    (box,) = marks.windows
    assert box.u < spot.u < box.u + box.width
    assert box.v < spot.v < box.v + box.height
