"""Time integration: owns the arrays of a simulation and advances them; sorts points after they have travelled."""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from mpmcol.mpm.constitutive import ConstitutiveLaw
from mpmcol.mpm.contact import Contacts, no_contacts
from mpmcol.mpm.grid import Grid, Tiles, no_tiles, share_tiles
from mpmcol.mpm.kernels import loop
from mpmcol.mpm.kernels.compilation import (
    compile_stress_update,
    shared_functions_compiled_meanwhile,
    shared_signatures,
)
from mpmcol.mpm.kernels.grid_update import NODE_REPORT
from mpmcol.mpm.kernels.particle_update import TILE_REPORT, Bodies
from mpmcol.mpm.kernels.sort import sort_buffers, sort_points
from mpmcol.mpm.kernels.step import State, alternates
from mpmcol.mpm.lanes import RECORD_SIZE
from mpmcol.mpm.particles import BASE, COLUMN, Points, aligned_zeros
from mpmcol.mpm.settings import PAPER, Scheme, Settings
from mpmcol.mpm.shape_functions import SHAPE_FUNCTIONS
from mpmcol.mpm.threads import compiled_calls, threads_in_use

CALL_SECONDS = 0.2  # duration of a call of the compiled loop; Python handles signals between calls
_FIRST_CALL_STEPS = 4


class Body(NamedTuple):
    """A constitutive law, its parameters, and the square of the wave speed at the initial density (m2/s2), Eq. 36."""

    law: ConstitutiveLaw
    params: Any
    wave_speed2: float


class Solver:
    """One simulation: points, grid, walls, laws of column, base and layers of the column, clock and ledger.

    The layers have the law of the column with other parameters.
    """

    def __init__(
        self,
        points: Points,
        grid: Grid,
        settings: Settings,
        column: Body,
        base: Body,
        scheme: Scheme = PAPER,
        contacts: Contacts | None = None,
        layers: Sequence[Body] = (),
    ) -> None:
        self.points = points
        self.grid = grid
        self.spare_nodes = aligned_zeros(len(grid.nodes)) if alternates(scheme) else grid.nodes
        self.contacts = contacts or no_contacts()
        self.settings = settings
        self.scheme = scheme
        self.bodies = (column, base, *layers)  # by kind of the points
        self.clock = np.zeros(loop.CLOCK)
        self.ledger = np.zeros(loop.LEDGER)
        self.tiles: Tiles | None = None
        self._shared: tuple[Tiles, int, np.ndarray] | None = None  # tiles, threads, and the tiles of each thread
        self.node_report, self.tile_report = np.zeros((0, NODE_REPORT)), np.zeros((0, TILE_REPORT))
        self.margin = 0  # tiles around the column beyond which the base is inactive; 0: all of it is active
        self.smallest_mass = float(points.m.min())
        self.buffers = sort_buffers(grid)
        self._steps_per_call = _FIRST_CALL_STEPS
        self.reset_time_step()

    @property
    def time(self) -> float:
        """Simulated time, s."""
        return float(self.clock[loop.TIME])

    @property
    def dt(self) -> float:
        """Next time step, s."""
        return float(self.clock[loop.DT])

    @property
    def steps(self) -> int:
        """Steps since the start of the run."""
        return int(self.clock[loop.STEPS])

    def reset_time_step(self) -> None:
        """Set the time step of Eq. 35-36 from the present state."""
        speed = np.sqrt(self.wave_speeds2() * self.points.J) + np.linalg.norm(self.points.v, axis=1)
        self.clock[loop.DT] = self.settings.cfl * self.grid.h / speed.max()

    def wave_speeds2(self) -> np.ndarray:
        """Squared speed of elastic waves in the material of each point at release, (n,), m2/s2."""
        return np.array([body.wave_speed2 for body in self.bodies])[self.points.kind.astype(np.intp)]

    def prepare(self) -> None:
        """Compile or load the kernels of the present laws, and sort the points if needed; takes no step."""
        with compiled_calls(compiling=True):
            state, dimension = self.state(), self.points.dimension
            shared = shared_signatures(state, self.sort_arguments())
            with shared_functions_compiled_meanwhile(dimension, self.scheme, shared):
                compile_stress_update(state, dimension, *self._laws(), self.scheme)
                self._call(self.time, 0)
            if self.tiles is None:
                self.sort()

    def sort(self) -> None:
        """Put the points in order of tiles, inactive ones last, and list the tiles that active points can reach."""
        self.set_tiles(Tiles(*sort_points(*self.sort_arguments())))
        self.clock[loop.TRAVELLED] = 0.0

    def sort_arguments(self) -> tuple[Any, ...]:
        """Arguments of `sort_points`."""
        rows, size, materials = self.points.rows.reshape(-1), RECORD_SIZE[self.points.dimension], len(self.bodies) - 1
        return rows, size, self.grid, *self.buffers, self.margin, materials

    def set_tiles(self, tiles: Tiles) -> None:
        """State that the points are in the order of `tiles`, as after a sort."""
        self.tiles = tiles
        self.node_report = np.zeros((len(tiles.active), NODE_REPORT))
        self.tile_report = np.zeros((len(tiles.split), TILE_REPORT))

    def advance(self, end: float, max_steps: int = 2**62) -> int:
        """Step until the time reaches `end` or `max_steps` are done, for at most about CALL_SECONDS.

        Returns the row of the first invalid point, or -1.
        """
        with compiled_calls():
            return self._advance(end, max_steps)

    def _advance(self, end: float, max_steps: int) -> int:
        started, first = time.perf_counter(), self.steps
        fault = -1
        while fault < 0 and self.time < end and self.steps - first < max_steps:
            if self.tiles is None or not loop.is_sorted(self.clock, SHAPE_FUNCTIONS[self.scheme.basis].TRAVEL_LIMIT):
                self.sort()
            fault = self._call(end, min(self._steps_per_call, max_steps - (self.steps - first)))
            if time.perf_counter() - started > CALL_SECONDS:
                break
        self._adapt_call(self.steps - first, time.perf_counter() - started)
        return fault

    def state(self) -> State:
        """What the compiled loop reads and writes; it takes steps only with sorted points."""
        column, base, *layers = self.bodies
        materials, tiles = (column, *layers), self.tiles or no_tiles()
        return State(
            rows=self.points.rows.reshape(-1),
            grid=self.grid,
            spare=self.grid._replace(nodes=self.spare_nodes),
            contacts=self.contacts,
            tiles=tiles,
            shares=self._shares(tiles),
            settings=self.settings,
            bodies=Bodies(
                np.array([body.params for body in materials]),
                base.params,
                np.array([body.wave_speed2 for body in materials]),
                base.wave_speed2,
            ),
            smallest_mass=self.smallest_mass,
            node_report=self.node_report,
            tile_report=self.tile_report,
            clock=self.clock,
            ledger=self.ledger,
        )

    def _shares(self, tiles: Tiles) -> np.ndarray:
        """The tiles of each thread, which change with the order of the points and with the number of threads only."""
        threads = threads_in_use()
        if self._shared is None or self._shared[0] is not tiles or self._shared[1] != threads:
            self._shared = tiles, threads, share_tiles(tiles, threads)
        return self._shared[2]

    def _laws(self) -> tuple[ConstitutiveLaw, ConstitutiveLaw]:
        return self.bodies[COLUMN].law, self.bodies[BASE].law

    def _call(self, end: float, steps: int) -> int:
        """Call the compiled loop once; `grid` then has the nodes of its last step."""
        time_loop, first = loop.make_time_loop(self.points.dimension, *self._laws(), self.scheme), self.steps
        fault = int(time_loop(self.state(), end, steps))
        done = self.steps - first
        if alternates(self.scheme) and done > 0 and done % 2 == 0:
            self.grid, self.spare_nodes = self.grid._replace(nodes=self.spare_nodes), self.grid.nodes
        return fault

    def _adapt_call(self, steps: int, seconds: float) -> None:
        """Choose the number of steps of the next call from the speed of the last."""
        if steps and seconds > 0.0:
            in_time = int(steps * CALL_SECONDS / seconds)
            self._steps_per_call = min(max(in_time, 1), 4 * self._steps_per_call)
