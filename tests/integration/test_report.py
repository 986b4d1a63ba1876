"""`mpmcol report`: contents for runs, sweeps and studies, and the pages in a browser."""

from __future__ import annotations

import html
import json
import os
import re
from collections.abc import Callable
from pathlib import Path

import pytest

from mpmcol.io.results import Results
from mpmcol.report.provenance import case_differences, case_files
from mpmcol.studies.judgement import judge
from mpmcol.sweep.axes import parse_axes
from mpmcol.sweep.plan import prepare_out, write_plan
from mpmcol.sweep.runner import make_plan
from mpmcol.sweep.runs import plan_runs
from mpmcol.sweep.scheduling import Allocation
from tests.support import browser
from tests.support.browser import Loaded, load, print_to_pdf
from tests.support.cli import invoke, set_options
from tests.support.report_folders import copy_run, write_study
from tests.support.runs import SMALL_CASES, TINY

HOSTILE = "<script>alert(1)</script>"
LARGEST = 5e6  # bytes
WIDTHS = (1280, 400)

pytestmark = pytest.mark.usefixtures("in_empty_folder")


def report_of(*arguments: object) -> str:
    """The report as text without entities."""
    done = invoke("report", *arguments)
    assert done.exit_code == 0, done.output
    return html.unescape(Path(done.stdout.strip()).read_text())


@pytest.fixture(scope="module")
def run(finished: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run whose title is hostile, with its report."""
    folder = tmp_path_factory.mktemp("report") / "run"
    title = json.dumps(Results(finished).case.title)
    copy_run(finished, folder, lambda result: None, (f"title = {title}", f'title = "{HOSTILE}"'))
    assert invoke("report", folder).exit_code == 0
    return folder


@pytest.fixture(scope="module")
def other(finished: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run with a runout twice as long, and another angle of friction."""
    folder = tmp_path_factory.mktemp("report") / "other"

    def change(result: dict) -> None:
        result["front"]["front_height"] = 3.0 * result["front"]["front_height"] - 2.0 * result["r_i"]
        result["warnings"] = [HOSTILE]
        del result["dissipation"], result["stress"], result["repose_angle_deg"]  # as by an earlier version

    return copy_run(finished, folder, change, ("friction_deg = 33.0", "friction_deg = 30.0"))


@pytest.fixture(scope="module")
def comparison(run: Path, other: Path) -> Path:
    """The report of two runs."""
    page = other.with_name("comparison.html")
    assert invoke("report", run, other, "--out", page).exit_code == 0
    return page


@pytest.fixture(scope="module")
def sweep(finished: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A sweep with its report; both of its runs are copies of the finished one."""
    folder = tmp_path_factory.mktemp("sweeps") / "sweep"
    settings = [*TINY, "material.friction_deg=30,33"]
    axes, _ = parse_axes(None, settings)
    runs = plan_runs("coarse-channel", axes, folder)
    write_plan(prepare_out(folder), make_plan(runs, Allocation(1, 1)))
    for planned in runs:
        copy_run(finished, planned.folder, lambda result: None)
    done = invoke("sweep", "coarse-channel", *set_options(settings), "--out", folder, "--jobs", 1, "--report")
    assert done.exit_code == 0 and f"report in {folder / 'report.html'}" in done.stderr, done.output
    return folder


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A study with its report."""
    folder = write_study(tmp_path_factory.mktemp("studies") / "study")
    assert invoke("report", folder).exit_code == 0
    return folder


def test_a_run_with_everything_that_a_reader_needs(run: Path) -> None:
    page, results = html.unescape((run / "report.html").read_text()), Results(run)
    for line in judge(results):
        assert line[1:] in page
    for text in (f"zeta = {results.summary['zeta']['front_height']:.3f}", f"beta = {results.summary['beta']:.3f}"):
        assert text in page
    for text in (results.summary["state_sha256"], results.summary["versions"]["numba"], *results.summary["warnings"]):
        assert text in page
    assert (run / "case.resolved.toml").read_text() in page
    assert len(re.findall('src="data:image/png', page)) == 5 and page.count('src="data:image/gif') == 1
    assert (run / "report.html").stat().st_size < LARGEST


@pytest.mark.parametrize("name", ["run", "comparison", "sweep", "study"])
def test_a_report_holds_no_script_and_loads_nothing(name: str, request: pytest.FixtureRequest) -> None:
    path: Path = request.getfixturevalue(name)
    page = (path if path.is_file() else path / "report.html").read_text()
    assert ("<script" not in page and "&lt;script&gt;" in page) or name == "sweep"
    assert all(value.startswith(("data:", "#")) for value in re.findall(r'\b(?:src|href)="([^"]*)"', page))


def test_the_charts_are_not_left_in_the_folder(run: Path, finished: Path) -> None:
    assert {path.name for path in run.iterdir()} == {path.name for path in finished.iterdir()} | {"report.html"}
    assert invoke("verify", run).stdout.count("report.html") == 0


def test_runs_are_compared_with_the_first(comparison: Path) -> None:
    page = html.unescape(comparison.read_text())
    assert "(+200.0%)" in page  # front - r_i is three times as long
    (row,) = re.findall(r"<tr>.*material.friction_deg \(deg\).*</tr>", page)
    assert row.endswith("<td class=\"number\">33</td><td class=\"number\">30</td></tr>")  # fmt: skip
    assert re.search(rf"<li>.*: {re.escape(HOSTILE)}</li>", page)
    assert page.count('src="data:image/gif') == 2
    assert "Runout by front_height, and height" in page and "each definition" not in page


def test_equal_cases_have_no_differences(finished: Path, run: Path) -> None:
    runs = [Results(finished), Results(run)]
    assert case_differences(runs, ["a", "b"]).rows == [("none", "", "")]


def test_runs_of_different_structure_are_compared() -> None:
    short = ("stages.collapse.max_time_factor=0.3", "output.snapshots=2")
    for name, overrides in {"dam": SMALL_CASES["walls"][1:], "cohesive-column": ("grid.spacing=0.25",)}.items():
        assert invoke("run", name, *set_options((*overrides, *short)), "--out", name).exit_code == 0
    for pair in (("dam", "cohesive-column"), ("cohesive-column", "dam")):
        page = report_of(*pair, "--out", "pair.html", "--overwrite")
        assert "walls.0.height (m)" in page and "material.tension (Pa)" in page


def test_the_case_as_given_is_shown_if_it_differs(finished: Path, tmp_path: Path) -> None:
    folder = copy_run(finished, tmp_path / "run", lambda result: None)
    given, resolved = folder / "case.toml", (folder / "case.resolved.toml").read_text()
    given.write_text(f"# copied\n{resolved}")
    assert case_files(Results(folder)) == [("case.resolved.toml", resolved)]
    given.write_text("schema = 1\n")
    assert case_files(Results(folder)) == [("case.toml", "schema = 1\n"), ("case.resolved.toml", resolved)]


def test_a_sweep_with_its_runs_and_charts(sweep: Path) -> None:
    page = html.unescape((sweep / "report.html").read_text())
    assert "2 runs: 2 done" in page and "grid.spacing = 0.015 m" in page
    assert page.count('src="data:image/png') == 2
    warnings = Results(next(sweep.glob("friction*/result.json")).parent).summary["warnings"]
    assert warnings and all(page.count(warning) == 1 for warning in warnings)  # both runs have them
    assert len(re.findall(r'<th scope="row">friction\w*</th><td>done, still moving</td>', page)) == 2


def test_a_sweep_whose_runs_all_failed(sweep: Path, tmp_path: Path) -> None:
    (tmp_path / "sweep.json").write_bytes((sweep / "sweep.json").read_bytes())
    header, row = "folder,status,a,law.zeta,law.beta,message", f"one-ab12,failed,1.0,1.6,1.0,{HOSTILE}"
    (tmp_path / "table.csv").write_text(f"{header}\n{row}\n")
    page = report_of(tmp_path)
    assert "1 run: 1 failed" in page and f"<li>one failed: {HOSTILE}</li>" in page and "<figure" not in page


def test_a_study_with_its_tables_and_pictures(study: Path) -> None:
    page = html.unescape((study / "report.html").read_text())
    assert "<h1>A study</h1>" in page and "<h3>Values</h3>" in page
    assert '<th scope="col">zeta</th>' in page and "<td>1.5</td>" in page and "0.1.0+abc" in page
    assert re.search('<img src="data:image/png[^>]*alt="chart" width="900" height="300"', page)


def test_a_run_writes_its_report_at_the_end() -> None:
    done = invoke("run", "coarse-channel", *set_options(TINY), "--out", "r", "--report", "--json")
    assert done.exit_code == 0 and "report in r/report.html" in done.stderr
    assert json.loads(done.stdout)["status"] == "done"
    assert Path("r/report.html").stat().st_size > 1e5


def test_certify_refuses_a_report() -> None:
    done = invoke("run", "coarse-channel", "--accuracy", "5%", "--certify", "--report")
    assert done.exit_code == 2 and "--report applies to a single run" in done.stderr


def test_another_file_is_kept_unless_overwritten(study: Path) -> None:
    Path("mine.html").write_text("mine")
    done = invoke("report", study, "--out", "mine.html")
    assert done.exit_code == 2 and "is not a report of mpmcol; use --overwrite" in done.stderr
    assert Path("mine.html").read_text() == "mine"
    assert "A study" in report_of(study, "--out", "mine.html", "--overwrite")


@pytest.mark.parametrize(("required", "outcome"), [("1", pytest.fail.Exception), ("", pytest.skip.Exception)])
def test_a_missing_browser_is_a_failure_where_it_is_required(
    required: str, outcome: type[BaseException], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(browser.REQUIRED, required)
    monkeypatch.setattr(browser.shutil, "which", lambda name: None)
    with pytest.raises(outcome):
        browser.find_browser()


def unfinish(folder: Path) -> None:
    (folder / "result.json").unlink()


def damage(name: str, content: bytes = b"damaged") -> Callable[[Path], None]:
    return lambda folder: (folder / name).write_bytes(content) and None


def end_as(status: str) -> Callable[[Path], None]:
    def spoil(folder: Path) -> None:
        path = folder / "result.json"
        kept = ("schema", "zeta", "beta", "points", "steps", "versions", "case_hash")
        result = {name: json.loads(path.read_text())[name] for name in kept}
        path.write_text(json.dumps(result | {"status": status, "failure": {"cause": "it exploded"}}))

    return spoil


def remove(name: str) -> Callable[[Path], None]:
    return lambda folder: (folder / name).unlink()


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (unfinish, "the run has not ended"),
        (end_as("stopped"), "the run was stopped"),
        (end_as("failed"), "the run failed: it exploded"),
        (end_as("done"), "result.json lacks area_factor, at_rest, base_used"),
        (end_as("odd"), "its status is 'odd'"),
        (damage("result.json", b'{"status": "done"}'), "it lacks schema"),
        (damage("result.json"), "cannot be read"),
        (damage("history.csv", b"stage,time\ncollapse,0.1\n"), "is missing or damaged"),
        (damage("snapshots/000001.vtkhdf"), "not a readable snapshot"),
        (damage("case.resolved.toml", b"\xff"), "case.resolved.toml"),
        (remove("case.resolved.toml"), "nothing to report here"),
    ],
)
def test_a_run_that_cannot_be_reported(
    finished: Path, tmp_path: Path, spoil: Callable[[Path], None], message: str
) -> None:
    folder = copy_run(finished, tmp_path / "run", lambda result: None)
    spoil(folder)
    refused(folder, message=message)
    assert not (folder / "report.html").exists()


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (remove("table.csv"), "the sweep has not ended"),
        (damage("table.csv", b"folder,status\na"), "is damaged"),
        (damage("table.csv", b"folder,status\na,done\n"), "lacks the columns a, law.beta, law.zeta, message"),
        (damage("zeta.png"), "zeta.png is damaged"),
        (damage("sweep.json"), "sweep.json cannot be read"),
    ],
)
def test_a_sweep_that_cannot_be_reported(
    sweep: Path, tmp_path: Path, spoil: Callable[[Path], None], message: str
) -> None:
    folder = tmp_path / "sweep"
    folder.mkdir()
    for path in filter(Path.is_file, sweep.iterdir()):
        os.link(path, folder / path.name)
    for name in ("table.csv", "zeta.png", "sweep.json"):  # those that are changed
        content = (folder / name).read_bytes()
        (folder / name).unlink()
        (folder / name).write_bytes(content)
    spoil(folder)
    refused(folder, message=message)


def test_folders_that_cannot_be_reported(run: Path, sweep: Path, study: Path, tmp_path: Path) -> None:
    refused(tmp_path, message="nothing to report here")
    refused(tmp_path / "none", message="no such folder")
    refused(run, sweep, message="is not a single run")
    refused(run, run, message="is given twice")
    refused(run, tmp_path, message="case.resolved.toml not found")


def test_a_study_without_its_picture_is_refused(tmp_path: Path) -> None:
    folder = write_study(tmp_path / "study")
    (folder / "a chart.png").unlink()
    refused(folder, message="a chart.png is missing")


def refused(*folders: Path, message: str) -> None:
    done = invoke("report", *folders)
    assert done.exit_code in (2, 5) and message in done.stderr, done.output
    assert "Traceback" not in done.stderr and not done.stdout


@pytest.mark.parametrize("name", ["run", "comparison", "sweep", "study"])
def test_a_browser_shows_all_of_a_report(name: str, request: pytest.FixtureRequest, tmp_path: Path) -> None:
    path: Path = request.getfixturevalue(name)
    pages, console = load(path if path.is_file() else path / "report.html", WIDTHS, tmp_path)
    assert console == []
    assert sorted(page.width for page in pages) == sorted(WIDTHS)
    for page in pages:
        assert page.content <= page.width
        assert page.images and all(image["natural"] > 0 and image["alt"] for image in page.images)
        assert all(image["right"] <= page.width for image in page.images)


def test_the_browser_finds_what_is_wrong_with_a_page(tmp_path: Path) -> None:
    page = tmp_path / "page.html"
    image = '<img alt="" src="data:image/png;base64,AAAA">'
    page.write_text(f'<body>{image}<div style="width: 900px">wide</div><script>throw Error("odd")</script></body>')
    (narrow,), console = load(page, WIDTHS[1:], tmp_path)
    assert narrow == Loaded(400, narrow.content, narrow.images) and narrow.content > 900
    assert narrow.images[0]["natural"] == 0
    assert len(console) == 1 and "odd" in console[0]


def test_a_report_can_be_printed(run: Path, tmp_path: Path) -> None:
    printed = print_to_pdf(run / "report.html", tmp_path / "report.pdf")
    assert printed.startswith(b"%PDF") and len(re.findall(rb"/Subtype ?/Image", printed)) >= 5
