"""Claims on writing: a file appears whole or not at all, whatever goes wrong."""

import errno
import os
import resource
from collections.abc import Callable
from pathlib import Path

import pytest

from refusal import complaint
from undula.storage.atomic import write_whole
from undula.storage.outputs import claimed


def claim(path: Path, *, overwrite: bool = False) -> None:
    with claimed(path, overwrite=overwrite):
        pass


WRITERS = [claim, lambda path: write_whole(path, b"new")]


@pytest.fixture
def earlier(tmp_path: Path) -> Path:
    path = tmp_path / "run.nc"
    path.write_bytes(b"earlier")
    return path


def test_a_file_holds_exactly_the_given_bytes_and_stands_alone(tmp_path: Path) -> None:
    path = tmp_path / "new" / "folder" / "run.nc"
    write_whole(path, b"content")
    assert path.read_bytes() == b"content"
    assert list(path.parent.iterdir()) == [path]


def test_a_file_has_the_permissions_of_any_new_file(tmp_path: Path) -> None:
    (tmp_path / "plain").write_bytes(b"")
    write_whole(tmp_path / "whole", b"")
    assert (tmp_path / "whole").stat().st_mode == (tmp_path / "plain").stat().st_mode


@pytest.mark.parametrize("write", WRITERS, ids=["claim", "write"])
def test_an_existing_file_is_replaced_only_when_asked(
    earlier: Path, write: Callable[[Path], None]
) -> None:
    sentence = f"{earlier} exists already; give --overwrite to replace it"
    assert complaint(lambda: write(earlier)) == sentence
    assert earlier.read_bytes() == b"earlier"


def test_a_claim_makes_the_folder_and_removes_it_if_nothing_comes_there(tmp_path: Path) -> None:
    with claimed(tmp_path / "new" / "folder" / "run.nc"):
        assert (tmp_path / "new" / "folder").is_dir()
    assert list(tmp_path.iterdir()) == []


def test_a_claim_leaves_the_file_that_it_may_replace(earlier: Path) -> None:
    claim(earlier, overwrite=True)
    assert earlier.read_bytes() == b"earlier"


@pytest.mark.parametrize("write", WRITERS, ids=["claim", "write"])
def test_a_folder_under_a_file_is_refused(earlier: Path, write: Callable[[Path], None]) -> None:
    sentence = complaint(lambda: write(earlier / "run.nc"))
    assert sentence.startswith(f"cannot write run.nc in {earlier} (")
    assert sentence.endswith("); choose a writable folder")


@pytest.mark.parametrize("write", WRITERS, ids=["claim", "write"])
def test_a_folder_in_place_of_the_output_is_refused(
    tmp_path: Path, write: Callable[[Path], None]
) -> None:
    sentence = f"{tmp_path} is a folder; give the name of a file"
    assert complaint(lambda: write(tmp_path)) == sentence


@pytest.mark.parametrize("function", ["replace", "fsync"])
@pytest.mark.parametrize("code", [errno.ENOSPC, errno.EDQUOT, errno.EACCES, errno.EIO])
def test_a_failed_write_leaves_the_earlier_file_and_nothing_else(
    earlier: Path, monkeypatch: pytest.MonkeyPatch, function: str, code: int
) -> None:
    def fail(*_: object) -> None:
        raise OSError(code, os.strerror(code))

    with monkeypatch.context() as broken:
        broken.setattr(os, function, fail)
        sentence = complaint(lambda: write_whole(earlier, b"new", overwrite=True))
    folder = earlier.parent
    full = f"the disk that holds {folder} is full; free some space or choose another folder"
    other = f"cannot write run.nc in {folder} ({os.strerror(code)}); choose a writable folder"
    expected = full if code in (errno.ENOSPC, errno.EDQUOT) else other
    assert sentence == expected
    assert earlier.read_bytes() == b"earlier"
    assert list(folder.iterdir()) == [earlier]


def test_a_file_that_cannot_grow_to_its_length_leaves_nothing_behind(tmp_path: Path) -> None:
    # A real limit of the system, met in the middle of the writing.
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, hard))
    try:
        sentence = complaint(lambda: write_whole(tmp_path / "run.nc", bytes(100_000)))
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert f"({os.strerror(errno.EFBIG)})" in sentence
    assert list(tmp_path.iterdir()) == []


def test_an_interrupt_in_the_middle_leaves_the_earlier_file_and_nothing_else(
    earlier: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(os, "replace", interrupt)
    with pytest.raises(KeyboardInterrupt):
        write_whole(earlier, b"new", overwrite=True)
    assert earlier.read_bytes() == b"earlier"
    assert list(earlier.parent.iterdir()) == [earlier]
