"""What files of tests about fits of made-up campaigns share."""

import pytest

from support.doubts import without_doubts


@pytest.fixture
def laws_that_hold(monkeypatch):
    """Made-up campaigns follow their laws exactly beyond the finest level, so that nothing is to be doubted there."""
    without_doubts(monkeypatch)
