import pytest
from yade import O

pytest.register_assert_rewrite("driven_block", "ensemble_programs", "rocking_scene")


@pytest.fixture(autouse=True)
def empty_scene():
    """Each test begins with YADE as it has just been started: no bodies, materials or engines, time zero."""
    O.reset()
