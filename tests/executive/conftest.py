import pytest

from tests.executive.record.synthetic import make_run


@pytest.fixture(scope="session")
def finished_run(tmp_path_factory):
    """A synthetic run folder; tests that change it take a copy."""
    return make_run(tmp_path_factory.mktemp("runs") / "synthetic")
