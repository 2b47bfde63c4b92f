"""Writing of video files, which appear whole or not at all."""

import os
import secrets
from collections.abc import Iterable
from pathlib import Path
from subprocess import DEVNULL, PIPE, Popen

import imageio_ffmpeg

from undula.errors import InputError

# Colour at half resolution (yuv420p), which every player supports; visually nearly lossless; with
# the index in front, so that the movie plays while it loads.
_ENCODING = [
    *("-c:v", "libx264", "-pix_fmt", "yuv420p"),
    *("-preset", "veryfast", "-crf", "20", "-movflags", "+faststart"),
    # The mark of undula, see `undula.storage.marks`.
    *("-metadata", "comment=undula"),
]


def check_video_path(path: Path) -> None:
    """Refuse a path to which no MP4 file can be written.

    Raises
    ------
    InputError
        The name does not end in .mp4, or the folder is missing or cannot be written.
    """
    if path.suffix.lower() != ".mp4":
        raise InputError(f"movie path {str(path)!r}: give a name that ends in .mp4")
    if path.is_dir():
        raise InputError(f"movie path {str(path)!r} is a folder: give the name of a file")
    if not path.parent.is_dir() or not os.access(path.parent, os.W_OK | os.X_OK):
        raise InputError(
            f"movie folder {str(path.parent)!r} cannot be written: "
            "create it, allow writing, or choose another"
        )


def write_video(path: Path, images: Iterable[memoryview], size: tuple[int, int], fps: int) -> None:
    """Encode images as H.264 in an MP4 file.

    Parameters
    ----------
    path : Path
        The file, which is written or replaced when the video is complete.
    images : iterable of memoryview
        Images of height by width by 4 bytes: red, green, blue, opacity.
    size : tuple of int
        Width and height in pixels, both even.
    fps : int
        Images per second.

    Raises
    ------
    InputError
        The folder cannot be written.
    OSError
        The encoder fails, or the disk is full. As after any other exception, no file is left.
    """
    check_video_path(path)
    partial = path.with_name(f".{path.stem}.{secrets.token_hex(4)}.part.mp4")
    # O_EXCL refuses existing names, links included, so that no link diverts the encoder.
    os.close(os.open(partial, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666))
    try:
        _encode(partial, images, size, fps)
        os.replace(partial, path)
    except BaseException:
        partial.unlink(missing_ok=True)
        raise


def _encode(path: Path, images: Iterable[memoryview], size: tuple[int, int], fps: int) -> None:
    # The exit status of the process reports even a disk that is full at the very end.
    with Popen(_command(path, size, fps), stdin=PIPE, stdout=DEVNULL, stderr=PIPE) as encoder:
        try:
            _send(encoder, images)
            _, errors = encoder.communicate()
        except BaseException:
            encoder.kill()
            encoder.communicate()
            raise
    if encoder.returncode != 0:
        reason = errors.decode(errors="replace").strip() or "it gave no reason"
        raise OSError(f"the video encoder failed: {reason}")


def _send(encoder: Popen[bytes], images: Iterable[memoryview]) -> None:
    """Send the images; a failed encoder reports by its exit status."""
    if encoder.stdin is None:
        return
    for image in images:
        try:
            encoder.stdin.write(image)
        except BrokenPipeError:
            return


def _command(path: Path, size: tuple[int, int], fps: int) -> list[str]:
    frames = ["-f", "rawvideo", "-pix_fmt", "rgba", "-s", f"{size[0]}x{size[1]}", "-r", str(fps)]
    ffmpeg = [imageio_ffmpeg.get_ffmpeg_exe(), "-loglevel", "error", "-y"]
    return [*ffmpeg, *frames, "-i", "-", *_ENCODING, str(path.absolute())]
