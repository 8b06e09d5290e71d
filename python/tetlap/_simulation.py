# SPDX-License-Identifier: Apache-2.0
"""A run that Python steps."""

from __future__ import annotations

import math
import os
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from . import _channel, _views
from ._channel import Channel
from ._errors import Error, UnknownNameError
from ._run import _Folder, _Server
from ._scene import OverlapModel, Scene, Settings, override_texts, scene_text, with_absolute_paths

if TYPE_CHECKING:
    import IPython.display
    import meshio
    import pyvista
    from numpy.typing import ArrayLike

_FORCES, _STRESS = 1, 2
_NEXT_ADVANCE = -1.0


def _named(names, name, what):
    known = ", ".join(repr(key) for key in names) or "none"
    return UnknownNameError(f"there is no {what} {name!r}; there is {known}")


def _seconds(value, what):
    try:
        value = float(value)
    except (TypeError, ValueError):
        raise TypeError(f"{what} is a number of seconds, not {value!r}") from None
    if math.isnan(value):
        raise ValueError(f"{what} is a number of seconds, not nan")
    return value


def _ramp(value):
    if value is None:
        return _NEXT_ADVANCE
    value = _seconds(value, "a ramp")
    if value < 0:
        raise ValueError(f"a ramp takes 0 seconds or more, not {value}; None: until the next advance ends")
    return value


def _check_callable(function, what):
    if not callable(function):
        raise TypeError(f"{what} takes a function, not {function!r}")
    return function


class Body:
    """A body of a Simulation, or an obstacle with a mesh: views of its arrays.

    Views are of shared memory and read-only. They always show the present time, so `.copy()` what is to be kept.
    """

    def __init__(self, simulation: Simulation, about: dict):
        arrays = simulation._channel.arrays
        self._simulation = simulation
        self._vertices = slice(about["vertex_begin"], about["vertex_end"])
        self._tets = slice(about["tet_begin"], about["tet_end"])
        self.name: str = about["name"]
        self.is_obstacle: bool = about["is_obstacle"]
        #: [kg]
        self.mass: float = about["mass"]
        #: current positions [m], a view (n, 3)
        self.points: np.ndarray = arrays["points"][self._vertices]
        #: [m/s], a view (n, 3)
        self.velocities: np.ndarray = arrays["velocities"][self._vertices]
        #: vertices of the tetrahedra, counted within the body (m, 4)
        self.tets: np.ndarray = arrays["tets"][self._tets] - about["vertex_begin"]

    def __setattr__(self, name, value):
        if "tets" in self.__dict__:
            raise AttributeError(f"body '{self.name}': {name} cannot be set; Simulation.restore sets a state, drive and loads act on a body")
        super().__setattr__(name, value)

    @property
    def forces(self) -> np.ndarray:
        """Contact's forces on the vertices, friction included [N], a view (n, 3)."""
        return self._simulation._filled(_FORCES, "forces")[self._vertices]

    @property
    def pressure(self) -> np.ndarray:
        """Contact's pressure at the surface [Pa], a view (n); 0 inside, and where the contact law has none."""
        return self._simulation._filled(_FORCES, "pressure")[self._vertices]

    @property
    def stress(self) -> np.ndarray:
        """Cauchy stress of the tetrahedra, xx yy zz xy yz xz [Pa], a view (m, 6)."""
        return self._simulation._filled(_STRESS, "stress")[self._tets]

    @property
    def von_mises(self) -> np.ndarray:
        """Of the same [Pa], (m)."""
        xx, yy, zz, xy, yz, xz = self.stress.T
        return np.sqrt(0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3 * (xy**2 + yz**2 + xz**2))

    def _fields(self):
        """Positions, tetrahedra, and arrays of vertices and of tetrahedra, copied: the present."""
        own = {} if self.is_obstacle else {"stress": self.stress.copy(), "von_mises": self.von_mises}
        return (self.points.copy(), self.tets.copy(),
                {"velocity": self.velocities.copy(), "contact_force": self.forces.copy(), "contact_pressure": self.pressure.copy()}, own)

    def to_meshio(self) -> meshio.Mesh:
        """A `meshio.Mesh` of the present, copied, with velocities, forces, pressure and stress. Error: there is no package meshio."""
        return _views.to_meshio(*self._fields())

    def to_pyvista(self) -> pyvista.UnstructuredGrid:
        """A `pyvista.UnstructuredGrid` of the same. Error: there is no package pyvista."""
        return _views.to_pyvista(*self._fields())

    def __repr__(self):
        return f"<Body {self.name!r}: {len(self.points)} vertices, {len(self.tets)} tetrahedra>"


class Contact:
    """What two do to each other at the present time; forces are those on the one that was named first."""

    def __init__(self, row: np.ndarray, a: str, b: str, sign: float):
        self._row, self._sign, self.a, self.b = row, sign, a, b

    def _of_a(self, begin):
        return self._sign * self._row[begin : begin + 3] + 0.0  # without -0

    @property
    def force(self) -> np.ndarray:
        """On `a`, friction included [N], (3)."""
        return self._of_a(0)

    @property
    def moment(self) -> np.ndarray:
        """Of that force about the origin [N m], (3); about p it is moment - cross(p, force)."""
        return self._of_a(3)

    @property
    def impulse(self) -> np.ndarray:
        """Of that force since the run began [N s], (3): differences of it are changes of momentum."""
        return self._of_a(9)

    @property
    def centre(self) -> np.ndarray:
        """Of pressure [m], (3); NaN: nothing presses."""
        return self._row[6:9].copy()

    @property
    def area(self) -> float:
        """Of contact [m²]."""
        return float(self._row[12])

    @property
    def pressure(self) -> float:
        """The force without friction over the area [Pa]."""
        return float(self._row[13])

    @property
    def slip(self) -> float:
        """The share of the area that slides; NaN: no friction, or no contact."""
        return float(self._row[14])

    @property
    def volume(self) -> float:
        """Of overlap [m³]."""
        return float(self._row[15])

    @property
    def touches(self) -> bool:
        """Whether they overlap."""
        return bool(self._row[16])

    def __repr__(self):
        return f"<Contact {self.a!r}, {self.b!r}: force {self.force} N>"


class _Bodies(Mapping):
    def __init__(self, bodies):
        self._bodies = {body.name: body for body in bodies}

    def __getitem__(self, name) -> Body:
        try:
            return self._bodies[name]
        except KeyError:
            raise _named(self._bodies, name, "body") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._bodies)

    def __len__(self):
        return len(self._bodies)


class _Contacts(Mapping):
    """By two names, in either order."""

    def __init__(self, about, rows):
        self._pairs = [(pair["a"], pair["b"]) for pair in about]
        self._contacts = {}
        for (a, b), row in zip(self._pairs, rows):
            self._contacts[a, b] = Contact(row, a, b, 1.0)
            if a != b:
                self._contacts[b, a] = Contact(row, b, a, -1.0)

    def __getitem__(self, names) -> Contact:
        try:
            return self._contacts[names]
        except (KeyError, TypeError):
            raise _named(self._pairs, names, "contact of") from None

    def __iter__(self):
        return iter(self._pairs)

    def __len__(self):
        return len(self._pairs)


class _Groups:
    """What the scene declares `external: true`: groups[name] = value, or groups.set(name, value, ramp=seconds)."""

    def __init__(self, simulation, kind, about):
        self._simulation, self._kind = simulation, kind
        self._vertices = {group["name"]: group["vertices"] for group in about if group["kind"] == kind}
        self._values = {name: np.zeros(3) for name in self._vertices}

    def __iter__(self):
        return iter(self._vertices)

    def __len__(self):
        return len(self._vertices)

    def __contains__(self, name):
        return name in self._vertices

    def __setitem__(self, name: str, value: ArrayLike) -> None:
        self.set(name, value)

    def __getitem__(self, name: str) -> np.ndarray:
        """What was set last, a copy; zeros before. NaN: not known, since a state of a file was restored."""
        self._check_name(name)
        return self._values[name].copy()

    def _check_name(self, name):
        if name in self._vertices:
            return
        what = "group that is driven from outside" if self._kind == "drive" else "load from outside"
        if not self._vertices:
            where = "entry of `driven` and no obstacle's `motion`" if self._kind == "drive" else "entry of `loads`"
            raise UnknownNameError(f"there is no {what} {name!r}: no {where} in the scene says `external: true`")
        raise _named(self._vertices, name, what)

    def _take(self, values):
        """The values of a state; None: not known."""
        self._values = dict(values) if values is not None else {name: np.full(3, np.nan) for name in self._vertices}

    def _check(self, name, value):
        self._check_name(name)
        try:
            value = np.asarray(value, dtype=np.float64)
        except (TypeError, ValueError) as error:
            raise TypeError(f"{name!r} was set to what is no array of numbers: {error}") from None
        shapes = [(3,)] if self._kind == "drive" else [(3,), (6,), (self._vertices[name], 3)]
        if value.shape not in shapes:
            raise ValueError(f"{name!r} was set to an array of shape {value.shape}; expected {' or '.join(map(str, shapes))}")
        return value

    def _send(self, name, value, ramp):
        value = self._check(name, value)
        kind = 0 if self._kind == "drive" else 1
        self._simulation._change(_channel.SET, name.encode() + b"\0" + value.tobytes(), a=_channel.bits(ramp), b=kind)
        self._values[name] = value.copy()


class Drive(_Groups):
    """Displacements from rest [m], (3), of groups that are driven from outside.

        sim.drive["finger"] = [0, 0, -0.001]                     reached where the next advance ends
        sim.drive.set("finger", [0, 0, -0.001], ramp=0.1)        reached in .1 s
    """

    def set(self, name: str, value: ArrayLike, ramp: float | None = None) -> None:
        """Moves the group straight on to a displacement, in `ramp` seconds; None: until the next advance ends."""
        self._send(name, value, _ramp(ramp))


class Loads(_Groups):
    """Loads from outside: a force [N] (3), shared evenly; force and moment about the mean of the group's vertices [N, N m] (6); or
    forces of its vertices [N] (n, 3). They keep their direction.

        sim.loads["ball"] = [0, 0, -1]                           from now on; in a static scene where the next advance ends
        sim.loads.set("ball", [0, 0, -1], ramp=0.1)              grown in .1 s; ramp=None: until the next advance ends
    """

    def set(self, name: str, value: ArrayLike, ramp: float | None = 0.0) -> None:
        """Changes the load straight on, in `ramp` seconds; None: until the next advance ends."""
        self._send(name, value, _ramp(ramp))


class State:
    """A state of a Simulation, in the memory of its program. It is dropped with this object.

    time: [s]
    """

    def __init__(self, simulation, number, time, values=None):
        self._simulation, self._number, self.time = simulation, number, time
        self._values = values  # of the groups; None: not known

    def write(self, path: str | os.PathLike) -> None:
        """As a file, which `Simulation.read_state` of the same scene reads, here or in another process."""
        self._simulation._channel.ask(_channel.WRITE, os.fspath(path).encode(), b=self._number)

    def __del__(self):
        self._simulation._dropped.append(self._number)

    def __reduce_ex__(self, _):
        raise TypeError("a State is neither copied nor pickled: State.write and Simulation.read_state hand it over as a file")

    def __repr__(self):
        return f"<State t={self.time} of {self._simulation!r}>"


class Simulation:
    """A run that is stepped: what it does can be read, set, kept and taken back at any time.

        with tetlap.Simulation("gripper.yaml") as sim:
            while sim.time < sim.end:
                sim.advance(0.01)
                force = sim.contacts["finger", "ball"].force
                sim.drive["finger"] = [0, 0, target(force)]

    scene: a scene file's path; or a dict with the same keys (docs/scene.md), whose paths count from the current directory
    set, overlap, threads: as for `tetlap.run`

    The program computes in a process of its own, which ends with `close`, the `with` block, or this object. Nothing is written.

    time: of the state that is shown [s]
    end: of the scene [s]
    bodies: Body by name
    contacts: Contact by two names
    drive, loads: Drive and Loads, what the scene declares `external: true`

    ValueError, TypeError, UnknownNameError: what was asked for makes no sense. RunError: the run failed, with its own message; after it a
    state can be restored. Error: it is closed, or used by two threads at once.
    """

    def __init__(self, scene: Scene, *, set: Settings = None,  # noqa: A002: as tetlap.run has it
                 overlap: OverlapModel | None = None, threads: int | None = None):
        self._folder, self._arguments = None, {"set": set, "overlap": overlap, "threads": threads}
        if isinstance(scene, Mapping):
            self._folder = _Folder()
            path = Path(self._folder.path, "scene.yaml")
            path.write_text(scene_text(with_absolute_paths(scene)) + "\n", encoding="utf-8")
            scene = path
        self._open(scene)

    def _open(self, scene, meanwhile=None):
        self._scene, self._dropped, self._fresh = scene, [], 0
        self._forget_callbacks()
        overlap = self._arguments["overlap"]
        self._server = _Server(overlap) if callable(overlap) else None
        try:
            self._channel = Channel(scene, override_texts(self._arguments["set"]), self._server.word if self._server else overlap,
                                    self._arguments["threads"], self._server.descriptors if self._server else (), meanwhile)
        finally:
            if self._server:
                self._server.hand_over()
        about = self._channel.about
        self.end: float = about["end"]
        self.is_static: bool = about["is_static"]
        self.bodies = _Bodies([Body(self, body) for body in about["bodies"]])
        self.contacts = _Contacts(about["contacts"], self._channel.arrays["contacts"])
        self.drive = Drive(self, "drive", about["groups"])
        self.loads = Loads(self, "load", about["groups"])

    def __enter__(self) -> Simulation:
        return self

    def __exit__(self, *_):
        self.close()

    def __del__(self):
        if hasattr(self, "_channel"):
            self.close()

    def __reduce_ex__(self, _):
        raise TypeError("a Simulation is neither copied nor pickled: fork() opens another one at the same state")

    def close(self) -> None:
        """Ends the program. Arrays that were read stay as they are."""
        self._channel.close()

    @property
    def time(self) -> float:
        """Of the state that is shown [s]."""
        return self._channel.time

    def _change(self, what, payload=b"", a=0, b=0, on_step=None):
        """A request after which nothing that was read stands."""
        try:
            return self._channel.ask(what, payload, a, b, on_step)[1]
        finally:
            self._fresh = 0

    def _filled(self, which, name):
        if not self._fresh & which:
            self._channel.ask(_channel.FILL, b=which)
            self._fresh |= which
        return self._channel.arrays[name]

    # ---- Time

    def advance(self, dt: float | None = None, *, until: float | None = None, stop: Callable[[Simulation], bool] | None = None) -> float:
        """Steps by `dt`, or to the time `until` [s]; the time that was reached.

        The integrator's own steps are as long as its tolerances allow, and the last one ends there. `stop` is asked after each
        step; where it returns true the advance ends: stop=lambda sim: sim.contacts["a", "b"].force[2] > 5.
        """
        if (dt is None) == (until is None):
            raise TypeError("advance takes a step, advance(0.01), or a time, advance(until=0.5)")
        until = self.time + _seconds(dt, "a step") if until is None else _seconds(until, "a time")
        if stop is not None:
            _check_callable(stop, "stop")
        watches = self._on_step or self._on_contact or stop
        self._change(_channel.ADVANCE, a=_channel.bits(until), b=1 if watches else 0, on_step=lambda: self._tell(stop))
        return self.time

    def on_step(self, function: Callable[[Simulation], object]) -> Callable:
        """From now on `function(sim)` is called after every step of the integrator; true ends the advance. Also a decorator."""
        self._on_step.append(_check_callable(function, "on_step"))
        return function

    def on_contact(self, function: Callable[[Simulation, Contact, bool], object]) -> Callable:
        """From now on `function(sim, contact, begins)` is called after the step in which two begin or cease to touch; true ends the
        advance. Also a decorator."""
        self._on_contact.append(_check_callable(function, "on_contact"))
        self._touching = self._find_touching()
        return function

    def _forget_callbacks(self):
        self._on_step, self._on_contact, self._touching = [], [], None

    def _find_touching(self):
        return [self.contacts[pair].touches for pair in self.contacts]

    def _tell(self, stop):
        self._fresh = 0
        answers = [function(self) for function in self._on_step]
        if self._on_contact:
            before, self._touching = self._touching, self._find_touching()
            for pair, was, now in zip(self.contacts, before, self._touching):
                if was != now:
                    answers += [function(self, self.contacts[pair], now) for function in self._on_contact]
        if stop:
            answers.append(stop(self))
        return any(answer is not None and bool(answer) for answer in answers)

    # ---- States

    def state(self) -> State:
        """The present state. The integrator begins anew here, as it does after every `restore`: both go on to the same bits."""
        while self._dropped:
            self._channel.ask(_channel.DROP, b=self._dropped.pop())
        return State(self, self._change(_channel.KEEP), self.time, self._group_values())

    def restore(self, state: State) -> None:
        """Back, or forth, to a state of this simulation."""
        if not isinstance(state, State):
            raise TypeError(f"restore takes what state() returned, not a {type(state).__name__}")
        if state._simulation is not self:
            raise ValueError("this state is of another Simulation: hand it over as a file, by State.write and read_state")
        self._change(_channel.RESTORE, b=state._number)
        self._take_group_values(state._values)
        self._touching = self._find_touching()

    def _group_values(self):
        return {group._kind: dict(group._values) for group in (self.drive, self.loads)}

    def _take_group_values(self, values):
        for group in self.drive, self.loads:
            group._take(values[group._kind] if values else None)

    def read_state(self, path: str | os.PathLike) -> State:
        """A state that State.write wrote, of the same scene and the same program."""
        number = self._channel.ask(_channel.READ, os.fspath(path).encode())[1]
        return State(self, number, self.time)

    def fork(self) -> Simulation:
        """Another Simulation at the present state, in a process of its own, with the same external groups. Callbacks stay here."""
        if callable(self._arguments["overlap"]):
            raise Error("a Simulation whose overlap model is a function of this process cannot fork")
        state = self.state()
        other = object.__new__(Simulation)
        other._folder, other._arguments = self._folder, self._arguments
        with tempfile.TemporaryDirectory(prefix="tetlap-") as folder:
            path = Path(folder, "state.h5")
            other._open(self._scene, meanwhile=lambda: state.write(path))
            other.restore(other.read_state(path))
        for mine, its in (self.drive, other.drive), (self.loads, other.loads):
            its._take(mine._values)
        return other

    def record(self, path: str | os.PathLike) -> None:
        """Writes what was set so far, and when, as lines of JSON: `tetlap run SCENE --replay PATH` does the same again."""
        self._channel.ask(_channel.RECORD, os.fspath(path).encode())

    def show(self, every: float = 0.2) -> IPython.display.DisplayHandle:
        """In a notebook: a view that follows the run, renewed after a step at most once in `every` seconds of wall time, and the
        display handle, whose `update` shows anything else. Error: there is no package IPython."""
        handle = _views.show_html(self._repr_html_())
        shown = time.monotonic()

        def follow(_):
            nonlocal shown
            if time.monotonic() - shown >= every:
                _views.show_html(self._repr_html_(), handle)
                shown = time.monotonic()

        self.on_step(follow)
        return handle

    def _repr_html_(self):
        """In a notebook: what touches, and a picture of the bodies at the present time, coloured by speed."""
        if not self._channel.is_open:
            return _views.table_html(repr(self), [])
        rows = [(f"{a}, {b}", contact.force.round(6).tolist(), _views.digits(contact.area))
                for (a, b), contact in self.contacts.items() if contact.touches]
        title = f"t = {self.time:.6g} of {self.end:.6g} s; {len(self.bodies)} bodies"
        bodies = list(self.bodies.values())
        points = np.concatenate([body.points for body in bodies])
        speed = np.concatenate([np.linalg.norm(body.velocities, axis=1) for body in bodies])
        begins = np.cumsum([0, *(len(body.points) for body in bodies)])
        tets = np.concatenate([body.tets + begin for body, begin in zip(bodies, begins)])
        picture = _views.outline_svg(points, tets, speed / max(speed.max(), 1e-300))
        return _views.grid_html(title, ("contact", "force [N]", "area [m²]"), rows) + picture

    def __repr__(self):
        what = f"t = {self.time:.6g} of {self.end:.6g} s" if self._channel.is_open else "closed"
        return f"<Simulation {os.fspath(self._scene)}: {what}>"
