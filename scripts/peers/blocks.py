"""Sort of points by blocks of cells, in Taichi, and lists of the occupied blocks and of those within reach."""

from math import prod

import taichi as ti

from scripts.peers.problem import Problem


@ti.data_oriented
class Blocks:
    """Points sorted by blocks of `shape` cells and by cell; blocks have 2^d colours, like a chessboard.

    The first node of a point's stencil determines its cell. A point may travel up to one cell before the next sort:
    with blocks of at least four cells a side its stencil overlaps no other block of the same colour.
    """

    def __init__(self, point, problem: Problem, shape: tuple[int, ...]) -> None:
        self.n, self.h, self.n_nodes, self.shape = len(problem.x), problem.h, problem.n_nodes, shape
        self.origin = tuple(problem.origin.tolist())
        self.dim, self.colours, self.cells = len(shape), 2 ** len(shape), prod(shape)
        self.counts = tuple(-(-nodes // cells) for nodes, cells in zip(self.n_nodes, shape, strict=True))
        self.total = prod(self.counts)
        self.points, self.spare = (point.field(shape=self.n) for _ in range(2))
        self.start = ti.field(int, self.total * self.cells + 1)  # first point of each cell
        self.position = ti.field(int, self.total * self.cells)
        self.occupied = ti.field(int, (self.colours, self.total))  # blocks with points, by colour
        self.n_occupied = ti.field(int, self.colours)
        self.reached = ti.field(int, self.total)  # blocks with points or beside one
        self.n_reached = ti.field(int, ())
        self.is_reached = ti.field(int, self.total)

    @property
    def nodes(self) -> tuple[int, ...]:
        """Nodes per axis of a grid of whole blocks."""
        return tuple(count * cells for count, cells in zip(self.counts, self.shape, strict=True))

    @ti.func
    def first(self, block):
        """First point of a block."""
        return self.start[block * self.cells]

    @ti.func
    def first_node(self, block):
        """First node of a block."""
        return self.index(block) * ti.Vector(self.shape)

    @ti.func
    def index(self, block):
        """Indices of a block along the axes."""
        index, rest = ti.Vector.zero(int, self.dim), block
        for a in ti.static(range(self.dim - 1, -1, -1)):
            index[a], rest = rest % self.counts[a], rest // self.counts[a]
        return index

    @ti.func
    def cell_of(self, p):
        """Number of the cell of a point, in order of blocks."""
        s = (self.points[p].x - ti.Vector(self.origin)) * (1.0 / self.h)
        block, cell = 0, 0
        for a in ti.static(range(self.dim)):
            i = ti.min(ti.max(ti.cast(s[a] - 0.5, int), 0), self.n_nodes[a] - 3)
            block, cell = block * self.counts[a] + i // self.shape[a], cell * self.shape[a] + i % self.shape[a]
        return block * self.cells + cell

    @ti.kernel
    def sort(self):
        """Counting sort of the points, and lists of the blocks."""
        self.position.fill(0)
        for p in range(self.n):
            self.position[self.cell_of(p)] += 1
        ti.loop_config(serialize=True)
        for c in range(self.total * self.cells):
            self.start[c + 1] = self.start[c] + self.position[c]
            self.position[c] = self.start[c]
        ti.loop_config(serialize=True)
        for p in range(self.n):
            c = self.cell_of(p)
            self.spare[self.position[c]] = self.points[p]
            self.position[c] += 1
        for p in range(self.n):
            self.points[p] = self.spare[p]
        self.n_occupied.fill(0)
        self.n_reached[None] = 0
        self.is_reached.fill(0)
        ti.loop_config(serialize=True)
        for block in range(self.total):
            if self.first(block + 1) > self.first(block):
                self.register(block)

    @ti.func
    def register(self, block):
        index, colour = self.index(block), 0
        for a in ti.static(range(self.dim)):
            colour += (index[a] % 2) << a
        self.occupied[colour, self.n_occupied[colour]] = block
        self.n_occupied[colour] += 1
        for offset in ti.static(ti.grouped(ti.ndrange(*((-1, 2),) * self.dim))):
            near, number = index + offset, 0
            if all(near >= 0) and all(near < ti.Vector(self.counts)):
                for a in ti.static(range(self.dim)):
                    number = number * self.counts[a] + near[a]
                if self.is_reached[number] == 0:
                    self.is_reached[number] = 1
                    self.reached[self.n_reached[None]] = number
                    self.n_reached[None] += 1
