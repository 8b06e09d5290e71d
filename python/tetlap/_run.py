# SPDX-License-Identifier: Apache-2.0
"""Runs of the program as a child process."""

from __future__ import annotations

import logging
import os
import shutil
import signal
import socket
import subprocess
import tempfile
import threading
import warnings
import weakref
from collections.abc import Callable, Mapping
from pathlib import Path

from . import _locate, serve
from ._errors import RunError
from ._results import Frame, Frames, Run
from ._scene import OverlapModel, Scene, Settings, override_texts, scene_text, with_absolute_paths
from ._overlap.wrapped import Wrapped

_log = logging.getLogger("tetlap")
_POLL_S = 0.02
_SERVER_S = 2  # for a function that still computes when the run has ended
_INTERRUPTED = 130


def _remove_folder(path, owner):
    if os.getpid() == owner:  # a fork of the interpreter has its own copy of the object, and not its own folder
        shutil.rmtree(path, ignore_errors=True)


class _Folder:
    """A temporary folder, removed with this object."""

    def __init__(self):
        self.path = tempfile.mkdtemp(prefix="tetlap-")
        weakref.finalize(self, _remove_folder, self.path, os.getpid())


class _Watch:
    """Hands new frames to a function. The program renews the list of frames after every frame; what a former run into
    the same folder left there is no news."""

    def __init__(self, directory, on_frame):
        self._directory, self._on_frame = directory, on_frame
        self._list = Path(directory, "frames.pvd")
        self._seen = self._stamp()
        self.count = 0

    def _stamp(self):
        try:
            state = self._list.stat()
        except FileNotFoundError:
            return None
        return state.st_ino, state.st_mtime_ns

    def look(self):
        """False: the function asks for the run to stop."""
        stamp = self._stamp()
        if stamp is None or stamp == self._seen:
            return True
        self._seen = stamp
        frames = Frames(self._directory)
        while self.count < len(frames):
            frame = frames[self.count]
            self.count += 1
            if self._on_frame(frame) is False:
                return False
        return True


class _Words(threading.Thread):
    """Reads what the program says: to the logger `tetlap`, and errors into a message."""

    def __init__(self, stream):
        super().__init__(daemon=True)
        self._stream, self.errors = stream, []
        self.start()

    def run(self):
        for line in self._stream:
            line = line.rstrip()
            label, _, rest = line.partition(": ")
            if label == "error" or label.startswith("tetlap "):  # the latter: an option that makes no sense
                self.errors.append(rest)
            elif label == "warning":
                _log.warning("%s", rest)
            else:
                _log.info("%s", line)
        self._stream.close()


class _Server(threading.Thread):
    """Answers the program's requests for overlaps by a function of ours (overlap/foreign/process.h)."""

    def __init__(self, function, name=None):
        super().__init__(daemon=True)
        self._wrappers = ""
        if isinstance(function, Wrapped):
            self._wrappers, function = function.words, function.model
        name = name or getattr(function, "__name__", type(function).__name__)
        self._function, self._name, self.error = function, "".join(c for c in name if c.isalnum() or c in "_-.") or "model", None
        ours, theirs = socket.socketpair()
        memory = os.memfd_create("tetlap-model")
        self._channel = serve.Channel(ours.detach(), os.dup(memory))
        self.descriptors = theirs.detach(), memory
        self.start()

    @property
    def word(self):
        return f"{self._wrappers}channel:{self.descriptors[0]}:{self.descriptors[1]}:{self._name}"

    def run(self):
        try:
            serve.attend(self._channel, lambda: serve.Model(self._function, self._name), self._keep)
        finally:
            self._channel.close()

    def _keep(self, error):
        self.error = error

    def hand_over(self):
        """The program has its copies of the descriptors, or there is no program: ours are closed, so that its end is seen."""
        for descriptor in self.descriptors:
            os.close(descriptor)
        self.descriptors = ()


def _stop(process):
    """Ctrl-C for the run, which then writes its summary; a second one kills it."""
    if process.poll() is None:
        process.send_signal(signal.SIGINT)
    try:
        process.wait()
    except BaseException:
        process.kill()
        process.wait()
        raise


def _follow(process, watch):
    """Until the run ends. Whatever happens here, and be it Ctrl-C, stops the run too. True: a frame's function stopped it."""
    try:
        while True:
            try:
                process.wait(_POLL_S if watch else None)
                break
            except subprocess.TimeoutExpired:
                pass
            if not watch.look():
                _stop(process)
                return True
        if watch:
            watch.look()
    except BaseException:
        _stop(process)
        raise
    return False


def _command(scene, directory, overrides, overlap, threads, strict, capture):
    words = [_locate.program(), "run", str(scene), "-o", str(directory)]
    for text in overrides:
        words += ["--set", text]
    if overlap is not None:
        words += ["--overlap", str(overlap)]
    if threads is not None:
        words += ["--threads", str(threads)]
    if capture is not None:
        words += ["--capture", str(capture)]
    return words + ["--strict"] if strict else words


def _start(command, server):
    process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                               errors="replace", pass_fds=server.descriptors if server else ())
    if server:
        server.hand_over()
    return process


def _execute(command, directory, on_frame, server):
    watch = _Watch(directory, on_frame) if on_frame else None
    process = _start(command, server)
    words = _Words(process.stderr)
    try:
        is_stopped = _follow(process, watch)
    finally:
        words.join()
        if server:
            server.join(_SERVER_S)
    code = process.returncode
    if code != 0 and not (is_stopped and code == _INTERRUPTED):
        message = "\n".join(words.errors) or (f"killed by signal {-code}" if code < 0 else f"exit code {code}")
        raise RunError(f"tetlap run failed: {message}", code, directory) from (server.error if server else None)
    if watch and watch.count == 0:
        warnings.warn("the run wrote no frames (output.vtu is false), so on_frame was not called", stacklevel=3)


def _place_scene(scene, directory):
    """A scene's file, the folder to write into, and what keeps that folder if it is temporary."""
    if not isinstance(scene, Mapping):
        return scene, directory if directory is not None else Path("out", Path(scene).stem), None
    text = scene_text(with_absolute_paths(scene))
    keeper = _Folder() if directory is None else None
    directory = directory if keeper is None else keeper.path
    Path(directory).mkdir(parents=True, exist_ok=True)
    file = Path(directory, "scene.yaml")
    file.write_text(text + "\n", encoding="utf-8")
    return file, directory, keeper


def run(scene: Scene, directory: str | os.PathLike | None = None, *, set: Settings = None,  # noqa: A002: as the program's option
        overlap: OverlapModel | None = None, threads: int | None = None, strict: bool = False, capture: str | os.PathLike | None = None,
        on_frame: Callable[[Frame], object] | None = None) -> Run:
    """Runs a scene with the program `tetlap`, in a process of its own; a `tetlap.Run` with what it wrote.

    scene: a scene file's path; or a dict with the same keys (docs/scene.md), whose paths count from the current
        directory. It is kept as scene.yaml in `directory`.
    directory: where the run writes. Default: out/NAME for a file, as the program does; for a dict a temporary
        folder that lives as long as the result.
    set: what to change in the scene, {"contact.stiffness": 1e6} or ["contact.stiffness=1e6"].
    overlap: the overlap model: a name or file, as the program's option; or a function, or a torch.nn.Module, that takes
        pairs (n, 2, 4, 3) and returns what docs/own_model.md says, {"volume": (n), "centroid": (n, 3), ...}. It is called
        in a thread of this process. What it raises is the cause of the RunError.
    threads, strict, capture: as the program's options.
    on_frame: called with every `Frame` soon after it was written. If it returns False, the run stops as by Ctrl-C,
        and what there is is returned; if it raises, the run stops and the exception goes on.

    Ctrl-C stops the run, which leaves whole files and a checkpoint, and is then raised. What the program says goes to
    the logger "tetlap".

    RunError: the program failed; it carries the program's message. Error: there is no program.
    """
    overrides = override_texts(set)
    scene, directory, temporary = _place_scene(scene, directory)
    server = _Server(overlap) if callable(overlap) else None
    word = server.word if server else overlap
    try:
        _execute(_command(scene, directory, overrides, word, threads, strict, capture), directory, on_frame, server)
    finally:
        if server:
            server.hand_over()
    return Run(directory, temporary)
