import pytest

from tests.proving.faults.bench import Bench


@pytest.fixture
def bench():
    return Bench()
