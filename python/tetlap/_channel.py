# SPDX-License-Identifier: Apache-2.0
"""The other end of `tetlap serve`: the program as a child process, a few words through a socket, arrays in shared memory.

app/loop/serve.h in the sources of tetlap has the protocol."""

import contextlib
import json
import mmap
import os
import socket
import struct
import subprocess
import threading

import numpy as np

from . import _locate
from ._errors import Error, RunError
from ._run import _Words

HELLO, ADVANCE, SET, FILL, KEEP, RESTORE, DROP, WRITE, READ, RECORD, GO = range(1, 12)
_VERSION, _STEP = 1, 1
_REQUEST = struct.Struct("=QQQQ")
_ANSWER = struct.Struct("=QQdQ")
_BITS = struct.Struct("=d")
_NUMBER = struct.Struct("=Q")
_PATIENCE_S = 5  # to end once its socket is closed
_USAGE, _INPUT = 64, 65


class _Refused(Exception):
    """What was asked for makes no sense; the run goes on."""


class _Raised(Exception):
    """A callback raised `error`; the advance ended with its step."""

    def __init__(self, error):
        super().__init__(str(error))
        self.error = error


def bits(value):
    return _NUMBER.unpack(_BITS.pack(value))[0]


class Channel:
    """A run of the program, which ends with this object's `close`.

    about: what the scene has, a dict
    arrays: views of the shared memory by name, read-only
    time: of the run [s]
    """

    def __init__(self, scene, overrides=(), overlap=None, threads=None, descriptors=(), meanwhile=None):
        """`meanwhile()` is called while the program opens the scene."""
        self._pid, self._lock, self._process = os.getpid(), threading.Lock(), None
        self._caller = None  # the thread that is in a callback
        self._ended_by = None  # what broke off a request in the middle
        ours, theirs = socket.socketpair()
        memory = os.memfd_create("tetlap-run")
        command = [_locate.program(), "serve", os.fspath(scene), "--quiet", f"--channel={theirs.fileno()},{memory}"]
        for text in overrides:
            command += ["--set", text]
        if overlap is not None:
            command += ["--overlap", str(overlap)]
        if threads is not None:
            command += ["--threads", str(threads)]
        self._socket, self.time = ours, 0.0
        try:
            # A session of its own: a Ctrl-C of the terminal is ours, and ends it.
            self._process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                                             text=True, errors="replace", start_new_session=True,
                                             pass_fds=(theirs.fileno(), memory, *descriptors))
            theirs.close()
            self._words = _Words(self._process.stderr)
            self._send(_REQUEST.pack(HELLO, 0, _VERSION, 0))
            if meanwhile:
                meanwhile()
            text, _ = self._listen(HELLO, None)
            self.about = json.loads(text)
            self._memory = mmap.mmap(memory, self.about["size"], prot=mmap.PROT_READ) if self.about["size"] else b""
        except BaseException:
            self.close()
            raise
        finally:
            theirs.close()
            os.close(memory)
        self.arrays = {name: self._view(**place) for name, place in self.about["arrays"].items()}

    def _view(self, offset, rows, columns, type):  # noqa: A002: the program's word
        array = np.frombuffer(self._memory, np.dtype(type), rows * columns, offset)
        return array if columns == 1 else array.reshape(rows, columns)

    @property
    def is_open(self):
        return self._socket is not None

    def _check(self):
        if os.getpid() != self._pid:
            raise Error("this Simulation belongs to the process that opened it; a fork of the interpreter has to open its own")
        if not self.is_open:
            raise Error(f"this Simulation is closed{f': it was ended by {self._ended_by}' if self._ended_by else ''}")

    def ask(self, what, payload=b"", a=0, b=0, on_step=None):
        """One request and its answer (text, b). `on_step` is called after each step; true stops the run there."""
        self._check()
        if what == FILL and self._caller == threading.get_ident():
            return self._exchange(what, payload, a, b, None)
        if not self._lock.acquire(blocking=False):
            raise Error("another thread, or a callback of this Simulation, is using it: one at a time")
        try:
            return self._exchange(what, payload, a, b, on_step)
        except RunError:
            raise
        except _Refused as error:
            raise ValueError(str(error)) from None
        except _Raised as raised:
            raise raised.error from None
        except BaseException as error:  # Ctrl-C: nobody knows where the words are
            self._ended_by = type(error).__name__
            self._kill()
            raise
        finally:
            self._lock.release()

    def _exchange(self, what, payload, a, b, on_step):
        self._send(_REQUEST.pack(what, len(payload), a, b) + payload)
        return self._listen(what, on_step)

    def _listen(self, what, on_step):
        raised = None
        while True:
            code, length, self.time, number = _ANSWER.unpack(self._receive(_ANSWER.size))
            text = self._receive(length).decode("utf-8", "replace") if length else ""
            if code != _STEP:
                break
            try:
                stop = self._call(on_step)
            except Exception as error:  # the run stops after this step and can be used
                raised, stop = error, True
            if not self.is_open:  # a callback has closed it
                raise _Raised(raised or Error("this Simulation is closed"))
            self._send(_REQUEST.pack(GO, 0, 0, 1 if stop else 0))
        if code in (_USAGE, _INPUT) and what != HELLO:
            raise _Refused(text)
        if code:
            raise RunError(text, code, None)
        if raised:
            raise _Raised(raised)
        return text, number

    def _call(self, on_step):
        self._caller = threading.get_ident()
        try:
            return on_step()
        finally:
            self._caller = None

    def _send(self, raw):
        try:
            self._socket.sendall(raw)
        except ConnectionError:
            self._tell_lost()

    def _receive(self, size):
        raw = bytearray()
        with contextlib.suppress(ConnectionError):
            while len(raw) < size and (part := self._socket.recv(size - len(raw))):
                raw += part
        if len(raw) < size:
            self._tell_lost()
        return bytes(raw)

    def _tell_lost(self):
        """The program has ended: what it said, or how."""
        self._close_socket()
        code = self._process.wait()
        self._words.join()
        how = "\n".join(self._words.errors) or (f"killed by signal {-code}" if code < 0 else f"exit code {code}")
        raise RunError(f"the program that steps the run has ended: {how}", code, None)

    def _close_socket(self):
        if self._socket is not None:
            self._socket.close()
            self._socket = None

    def _kill(self):
        self._close_socket()
        if self._process is not None and self._process.poll() is None:
            self._process.kill()
            self._process.wait()

    def end(self):
        """Ends the program, whatever it does; from any thread. Who waits for it gets a RunError."""
        if self._process is not None:
            self._process.kill()

    def close(self):
        """Ends the program. Views stay what they were."""
        if os.getpid() != self._pid:  # of a fork: the program is not its
            return
        self._close_socket()
        if self._process is None:
            return
        try:
            self._process.wait(_PATIENCE_S)
        except subprocess.TimeoutExpired:
            self._kill()
