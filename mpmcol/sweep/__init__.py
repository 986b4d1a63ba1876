"""Many runs as one: the points of a sweep, the engines that carry them out, and what comes out as tables and charts.

    points = plan_runs("lube-cylinder", [Axis("geometry.aspect", parse_values("0.5:7"))], Path("sweeps/cylinder"))
    for outcome in execute_runs(points):
        print(outcome.run.name, outcome.status)

Every point is the folder of a run, named by the hash of its resolved case and of the code's version. Its result.json
marks it as done; what is done is never run again.
"""
