"""Parameter sweeps: plan runs over the values of case keys, execute them, and report tables, fits and charts.

    runs = plan_runs("cylinder", [Axis("geometry.aspect", parse_values("0.5:7"))], Path("sweeps/cylinder"))
    for outcome in execute_runs(runs):
        print(outcome.run.name, outcome.status)

Each run has its own results folder, named by its values and by a hash of its resolved case and of the version of the
code. A run whose result.json states that it has ended is not repeated.
"""
