"""A notebook as a script: each cell begins with `# %%`; run it with `python`, VS Code, Spyder or Jupyter (jupytext).

Results go to the folder `example` in the current folder; a repeated cell computes nothing twice.
"""

# %% A cylinder of sand on a coarse grid: a shipped case with some values replaced
import mpmcol

COARSE = ["grid.spacing=9.7 mm", "output.snapshots=5"]
case = mpmcol.load_case("quickstart", COARSE)
results = mpmcol.run(case, "example/quickstart")
print(results)  # as the last line of a cell, `results` alone shows a table

# %% What was measured, and what experiments give
measured = mpmcol.measure(results)
print(f"runout zeta = {measured.measurement.zeta['front_height']:.3f}, height beta = {measured.measurement.beta:.3f}")
for score in measured.scores:
    if score.error is not None and score.front_definition in ("front_height", ""):
        print(f"  {score.quantity}: {score.error:+.1%} relative to {score.experiment} ({score.expected:.3f})")

# %% Arrays: the shape of the deposit
last = results.snapshot(-1)
print(f"{last.column.sum()} material points in the column, the farthest at x = {last.x[last.column, 0].max():.3f} m")

# %% Charts
for path in mpmcol.plot(results, out="example/charts"):
    print(path)

# %% A sweep over two aspect ratios; its runs are processes of their own
sweep = mpmcol.sweep(case, aspect=[1, 2], out="example/sweep")
print(sweep)

# %% The table
print(f"{'a':>5} {'zeta':>8} {'beta':>8}")
for a, zeta, beta in zip(sweep.column("a"), sweep.column("zeta.front_height"), sweep.column("beta"), strict=True):
    print(f"{a:5.2f} {zeta:8.3f} {beta:8.3f}")

# %% Errors are exceptions with a message for the user
try:
    mpmcol.load_case("quickstart", ["grid.spacing=-1"])
except mpmcol.errors.MpmcolError as error:
    print(error)
