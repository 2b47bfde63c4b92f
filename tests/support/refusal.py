"""What the tests of refused input share: the sentence that the user would read."""

from collections.abc import Callable

import pytest

from undula.errors import InputError


def complaint(act: Callable[[], object]) -> str:
    """Return the sentence with which `act` is refused, having checked that it is one line."""
    with pytest.raises(InputError) as caught:
        act()
    sentence = str(caught.value)
    assert len(sentence.splitlines()) == 1
    return sentence
