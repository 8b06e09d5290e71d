# SPDX-License-Identifier: Apache-2.0
"""Many runs side by side.

The function is called in threads of this process, each of which steps a Simulation, a process of its own: so it may be any function,
and the threads wait while the programs compute. `tetlap sweep` runs whole scenes without Python; both take their share of the cores
from the same function of the program (app/sweep/crew.h)."""

from __future__ import annotations

import functools
import hashlib
import inspect
import json
import logging
import os
import queue
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

from . import _locate
from ._errors import RunError
from ._run import _INTERRUPTED, _Folder
from ._scene import OverlapModel, Scene, Settings, override_texts, scene_text, with_absolute_paths
from ._simulation import Simulation
from ._table import Failure, Results, Table, as_row
from ._overlap.wrapped import Wrapped

_log = logging.getLogger("tetlap")
_COMMIT_S = 1.0  # what a kill may cost, and how often progress is told to a terminal
_TELL_S = 30.0  # the same to the logger
_PATIENCE_S = 5.0  # for a function that computes when the map is stopped


def _digest(*texts):
    return hashlib.sha256("\0".join(texts).encode()).hexdigest()[:32]


def _plain_texts(values):
    """Of numbers, text, lists, dicts and arrays; other values, which have no text that lasts, by their class."""
    texts = []
    for value in values:
        try:
            texts.append(scene_text(value))
        except TypeError:
            texts.append(type(value).__qualname__)
    return texts


def _function_text(function):
    """What says that a function is the same: its source, or its code where there is no source."""
    if isinstance(function, functools.partial):
        return f"{_function_text(function.func)} {_plain_texts([*function.args, function.keywords])}"
    if isinstance(function, Wrapped):
        return f"{function.words} {_function_text(function.model)}"
    if not inspect.isroutine(function) and not inspect.isclass(function):
        function = type(function)
    try:
        return inspect.getsource(function)
    except (OSError, TypeError):
        code = getattr(function, "__code__", None)
        return f"{function.__module__}.{function.__qualname__}" + (f" {code.co_code.hex()} {code.co_consts!r}" if code else "")


def _scene_words(scene):
    if isinstance(scene, Mapping):
        return scene_text(with_absolute_paths(scene))
    return f"{Path(scene).absolute()} {hashlib.sha256(Path(scene).read_bytes()).hexdigest()}"


def _item_key(index, item, is_scene):
    try:
        return _digest(_scene_words(item) if is_scene else scene_text(item, f"item {index}"))
    except TypeError as error:
        what = "scenes: a path or a dict" if is_scene else "parameters made of numbers, text, lists, dicts and arrays"
        raise TypeError(f"item {index} ({type(item).__name__}): {error}; items are {what}") from None


def _divide_cores(processes, threads, count):
    """Runs at once, threads of each, and the program's version."""
    for name, value in (("processes", processes), ("threads", threads)):
        if value is not None and (isinstance(value, bool) or not isinstance(value, int) or value < 1):
            raise ValueError(f"{name} is {value!r}; expected a number of at least 1, or None")
    done = subprocess.run([_locate.program(), "serve", "-", "--divide", f"{processes or 0},{threads or 0},{count}"],
                          stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RunError(f"tetlap serve failed: {done.stderr.strip()}", done.returncode, None)
    share = json.loads(done.stdout)
    return share["jobs"], share["threads"], share["program"]


class _Scenes:
    """Opens the Simulation of an item."""

    def __init__(self, scene, arguments):
        self._scene, self._arguments = scene, arguments
        self.is_shared = scene is not None and not callable(scene)

    def open(self, item):
        scene = self._scene
        if callable(scene):
            scene = scene(item)
        elif scene is None:
            scene = item
        return Simulation(scene, **self._arguments)

    def describe(self):
        """What the results depend on, beside the items."""
        scene = "of the items" if self._scene is None else _function_text(self._scene) if callable(self._scene) else _scene_words(self._scene)
        overlap = self._arguments["overlap"]
        overlap = _function_text(overlap) if callable(overlap) else str(overlap)
        return {"scene": _digest(scene, *override_texts(self._arguments["set"])), "overlap model": _digest(overlap)}


def _find_inputs(simulation):
    """A digest of the scene as the program understands it, its meshes and weights."""
    origin = simulation._channel.about["origin"]
    return _digest(json.dumps({key: origin.get(key) for key in ("scene", "meshes", "weights")}, sort_keys=True))


class _Worker(threading.Thread):
    """Takes items, calls the function, says what came of it."""

    def __init__(self, scenes, function, items, tasks, outcomes):
        super().__init__(daemon=True)
        self._scenes, self._function, self._items, self._tasks, self._outcomes = scenes, function, items, tasks, outcomes
        self._simulation, self._begin, self._is_stopped = None, None, False

    def run(self):
        try:
            while not self._is_stopped:
                try:
                    index = self._tasks.get_nowait()
                except queue.Empty:
                    break
                self._outcomes.put((index, *self._do(self._items[index])))
        except BaseException as error:  # SystemExit of the function, no memory: the map ends with it
            self._outcomes.put((None, None, error))
        finally:
            self._close()
            self._outcomes.put((None, None, None))

    def _do(self, item):
        """(row, None) or (None, exception)"""
        try:
            self._prepare(item)
            row = as_row(self._function(self._simulation, item))
            self._refuse_if_stopped()  # a function that goes on when its run ends would return what it had so far
        except Exception as error:
            self._close()
            return None, error
        if not self._scenes.is_shared:
            self._close()
        return row, None

    def _prepare(self, item):
        """A Simulation at its beginning: a new one, or that of the item before taken back, which has the same bits."""
        if self._simulation is not None and self._simulation._channel.is_open:
            self._simulation._forget_callbacks()
        else:
            self._simulation = self._scenes.open(item)
            self._begin = self._simulation.state()
        self._refuse_if_stopped()  # while it was opened
        if self._scenes.is_shared:
            self._simulation.restore(self._begin)

    def _refuse_if_stopped(self):
        if self._is_stopped:
            raise RunError("the map was stopped", _INTERRUPTED, None)

    def _close(self):
        simulation, self._simulation, self._begin = self._simulation, None, None
        if simulation is not None:
            simulation.close()

    def stop(self):
        """From another thread: no more items, and the program ends."""
        self._is_stopped = True
        simulation = self._simulation
        if simulation is not None:
            simulation._channel.end()


class _Progress:
    """To a terminal a line that is renewed; to the logger a line now and then."""

    def __init__(self, to_do, is_shown):
        self._to_do, self._began, self._told = to_do, time.monotonic(), time.monotonic()
        self._is_shown = sys.stderr.isatty() if is_shown is None else is_shown
        self.good = self.failed = 0

    def _words(self):
        ended = self.good + self.failed
        left = (time.monotonic() - self._began) * (self._to_do - ended) / max(ended, 1)
        words = f"{ended} of {self._to_do}" + (f", {self.failed} failed" if self.failed else "")
        if 0 < ended < self._to_do:
            words += f"; about {left:.0f} s left" if left < 120 else f"; about {left / 60:.0f} minutes left"
        return words

    def tell(self, is_last=False):
        if self._is_shown:
            print(f"\r{self._words():60}", end="\n" if is_last else "", file=sys.stderr, flush=True)
        elif is_last or time.monotonic() - self._told > _TELL_S:
            self._told = time.monotonic()
            _log.info("%s", self._words())


class _Crew:
    """The workers and the table that they fill."""

    def __init__(self, workers, table, progress):
        self._workers, self._table, self._progress = workers, table, progress
        self._good, self._failures, self._committed = [], [], time.monotonic()

    def work(self, outcomes):
        try:
            for worker in self._workers:
                worker.start()
            at_work = len(self._workers)
            while at_work:
                try:
                    index, row, error = outcomes.get(timeout=_COMMIT_S)
                except queue.Empty:
                    self._commit_now_and_then()
                    continue
                if index is not None:
                    self._keep(index, row, error)
                elif error is not None:
                    raise error
                else:
                    at_work -= 1
                self._commit_now_and_then()
        except BaseException:
            self._stop()
            self._keep_good(outcomes)
            raise
        finally:
            self._commit()
            self._progress.tell(is_last=True)

    def _keep_good(self, outcomes):
        """What had ended when the map was stopped. What failed then may have failed by that."""
        while True:
            try:
                index, row, error = outcomes.get_nowait()
            except queue.Empty:
                return
            if index is not None and error is None:
                self._keep(index, row, None)

    def _keep(self, index, row, error):
        if error is None:
            try:
                self._table.put(index, row)
            except ValueError as other:
                error = other
        if error is None:
            self._good.append(index)
            self._progress.good += 1
            return
        failure = Failure(index, type(error).__name__, str(error))
        _log.warning("item %d failed: %s: %s", index, failure.kind, failure.message)
        self._failures.append(failure)
        self._progress.failed += 1

    def _commit(self):
        if self._good or self._failures:
            self._table.commit(self._good, self._failures)
        self._good, self._failures, self._committed = [], [], time.monotonic()

    def _commit_now_and_then(self):
        if time.monotonic() - self._committed > _COMMIT_S:
            self._commit()
            self._progress.tell()

    def _stop(self):
        """All programs end at once; what their runs had reached is not kept."""
        end = time.monotonic() + _PATIENCE_S
        for worker in self._workers:
            worker.stop()
        for worker in self._workers:
            if worker.ident is not None:
                worker.join(max(0.0, end - time.monotonic()))


def map(  # noqa: A001: as the language's own, but over processes
    items: Iterable,
    f: Callable[[Simulation, object], Mapping],
    directory: str | os.PathLike | None = None,
    *,
    scene: Scene | Callable[[object], Scene] | None = None,
    set: Settings = None,  # noqa: A002: as tetlap.run has it
    overlap: OverlapModel | None = None,
    processes: int | None = None,
    threads: int | None = None,
    again: bool = False,
    progress: bool | None = None,
) -> Results:
    """Calls `f(sim, item)` for every item, side by side on the cores, and keeps what it returns as arrays: `tetlap.Results`.

        def press(sim, p):
            sim.drive["ball"] = [p["x"], 0, -p["depth"]]
            sim.advance(until=sim.end)
            return {"force": sim.contacts["ball", "pad"].force, "points": sim.bodies["pad"].points}

        results = tetlap.map([{"x": x, "depth": 1e-3} for x in (0, 1e-3, 2e-3)], press, "out/press", scene="press.yaml")
        results["force"]                            # (3, 3) [N]

    items: what the runs differ in. Without `scene` each is a scene, a file or a dict, as Simulation takes it. With `scene` they are
        parameters: numbers, text, lists, dicts, arrays.
    f: gets a Simulation at its beginning and the item; returns numbers and arrays by name, the same names and shapes for every item.
        It is called in a thread of this process, so it may be any function, and should leave long computations to the program.
    directory: a folder that holds nothing else, a NumPy file a field. Given again it is continued: items that are good are kept, the
        others run, and more items may be added at the end. Default: a temporary folder that lives as long as the results.
    scene: a scene for all items, which is opened once a process and taken back to its beginning for each; or a function of the item
        that returns a scene.
    set, overlap: as for `tetlap.run`, for all.
    processes: runs at once; default: one a core
    threads: of each run; default: the cores divided among the runs. Results do not depend on either.
    again: failed items of an earlier map are run again. Otherwise they stay failed.
    progress: whether a line on standard error says how far it is. Default: if that is a terminal; else the logger "tetlap" is told.

    An item whose run fails, or whose `f` raises, is in `results.failures` with its message, and never among the rows; the others go on.
    Ctrl-C ends all runs; a row is there whole or not at all, and the same call goes on with the others.

    ValueError: there are no items, or the folder's results are of another function (its text), scene, mesh or program, or of other items.
    RunError: a `scene` that is for all cannot be opened. Error: another process fills the folder.
    """
    items = list(items)
    if not items:
        raise ValueError("there are no items: nothing to run")
    overrides = override_texts(set)
    temporary = _Folder() if directory is None else None
    directory = Path(temporary.path if temporary else directory)
    jobs, threads, program = _divide_cores(processes, threads, len(items))
    scenes = _Scenes(scene, {"set": overrides, "overlap": overlap, "threads": threads})
    origin = {"function": _digest(_function_text(f)), "program": program, **scenes.describe()}
    first = scenes.open(None) if scenes.is_shared else None  # a scene that cannot be read is told before anything is written
    try:
        if first:
            origin["mesh or weights file"] = _find_inputs(first)
        keys = [_item_key(index, item, scene is None) for index, item in enumerate(items)]
        table = Table(directory, keys, origin)
    finally:
        if first:
            first.close()
    try:
        waiting = table.find_waiting(again)
        tasks, outcomes = queue.SimpleQueue(), queue.SimpleQueue()
        for index in waiting:
            tasks.put(index)
        workers = [_Worker(scenes, f, items, tasks, outcomes) for _ in range(min(jobs, len(waiting)))]
        _Crew(workers, table, _Progress(len(waiting), progress)).work(outcomes)
    finally:
        table.close()
    return Results(directory, temporary)
