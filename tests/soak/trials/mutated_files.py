"""Shipped cases and studies with mutated bytes are read, or refused with file and line."""

from __future__ import annotations

import random
from collections.abc import Callable
from functools import cache
from itertools import islice
from pathlib import Path

from mpmcol.case import flattened_text, key_names, shipped_cases
from mpmcol.errors import CaseError, UsageError
from mpmcol.studies.pareto.study import configurations_of, load_study, shipped_studies
from tests.support.bad_input import failure_in_reading, failure_in_refusal, find_failure

COUNT = 100_000
MUTATIONS_OF_A_TRIAL = (1, 1, 1, 2, 4)
STRANGE = (
    b"\0", b"\xff", b"\xef\xbb\xbf", b"\r\n", b"\r", b"\n", b"\t", b"\x1b[31m", "\u202e".encode(), "\u00a0".encode(),
    "é".encode(), "\U0001f3d6".encode(), b"\xed\xa0\x80", b"\x85", b" ", b"#", b"[", b"]", b"{", b"}", b"=", b".", b",",
    b'"', b"'", b'"""', b"'''", b"\\", b"\\u0000", b"[[", b"]]", b"-", b"+", b"_", b"true", b"nan", b"-inf",
    b"1979-05-27", b"07:32:00", b"0x", b"1e", b"extends", b"schema = 2\n",
)  # fmt: skip
NUMBERS = (
    b"0", b"-0.0", b"-1", b"1e-320", b"1e308", b"1e309", b"nan", b"inf", b"-inf", b"9" * 18, b"9" * 20, b"9" * 5000,
    b"0x" + b"f" * 15, b"0x" + b"f" * 5000, b"1_000", b'"1 mm"', b'"1 furlong"', b'"1e400 m"', b'"%"', b"true", b"[]",
    b"{}", b"1,5", b".3", b"3.", b"4.0", b"33\xc2\xb0", b'"33\xc2\xb0"', b'"1,5 mm"', b'"2.5mm"',
    b'"C:\\cases\\a.toml"', b"'", b'"' + b"1" * 20_000 + b' m m"', b'"1' + b" " * 20_000 + b'm m"',
)  # fmt: skip

Mutation = Callable[[random.Random, bytearray], None]


def trial(seed: int, folder: Path) -> str | None:
    """Read one mutated file as a case, or as a study."""
    draw = random.Random(seed)
    name = draw.choice(list(_texts()))
    text = bytearray(_texts()[name])
    for _ in range(draw.choice(MUTATIONS_OF_A_TRIAL)):
        draw.choice(MUTATIONS)(draw, text)
    path = folder / "my.toml"
    path.write_bytes(text)
    read = _failure_in_study if name.startswith("study ") else failure_in_reading
    return find_failure(lambda: read(path))


@cache
def _texts() -> dict[str, bytes]:
    flattened = {name: flattened_text(name).encode() for name in shipped_cases()}
    return {
        **flattened,
        **{f"file {name}": path.read_bytes() for name, path in shipped_cases().items()},
        **{f"study {name}": path.read_bytes() for name, path in shipped_studies().items()},
    }


def _failure_in_study(path: Path) -> str | None:
    try:
        for configuration in islice(configurations_of(load_study(str(path))), 3):
            configuration.runs[0].plan(path.parent)
    except CaseError as error:
        return failure_in_refusal(error)
    except UsageError as error:
        return None if "my.toml" in str(error) else f"the message names no file: {error}"
    return None


def _span(draw: random.Random, text: bytearray, longest: int) -> slice:
    start = draw.randrange(len(text) + 1)
    return slice(start, start + draw.randint(1, longest))


def _flip(draw: random.Random, text: bytearray) -> None:
    if text:
        text[draw.randrange(len(text))] ^= 1 << draw.randrange(8)


def _delete(draw: random.Random, text: bytearray) -> None:
    del text[_span(draw, text, draw.choice((1, 4, 40, 400)))]


def _repeat(draw: random.Random, text: bytearray) -> None:
    span = _span(draw, text, draw.choice((1, 20, 200)))
    text[span.start : span.start] = text[span] * draw.choice((1, 1, 2, 50, 400))


def _splice(draw: random.Random, text: bytearray) -> None:
    other = draw.choice(list(_texts().values()))
    text[_span(draw, text, 60)] = other[_span(draw, bytearray(other), 300)]


def _strange(draw: random.Random, text: bytearray) -> None:
    at = draw.randrange(len(text) + 1)
    text[at : at + draw.randint(0, 2)] = draw.choice(STRANGE)


def _number(draw: random.Random, text: bytearray) -> None:
    """Replace the value after an equals sign."""
    places = [i + 1 for i, byte in enumerate(text) if byte == ord("=")]
    if places:
        start = draw.choice(places)
        end = text.find(b"\n", start)
        text[start : end if end > 0 else len(text)] = b" " + draw.choice(NUMBERS)


def _habit(draw: random.Random, text: bytearray) -> None:
    """Write lines as in YAML, INI or a spreadsheet."""
    old, new = draw.choice(((b" = ", b": "), (b" = ", b"="), (b" = ", b";"), (b".", b","), (b'"', b""), (b"[", b"[[")))
    count = draw.choice((1, 2, 1000))
    start = draw.randrange(len(text) + 1)
    text[start:] = text[start:].replace(old, new, count)


def _line(draw: random.Random, text: bytearray) -> None:
    """Insert a line with a key of the schema, or a table."""
    key = draw.choice(key_names()).encode()
    lines = (b"\n%s = %s\n" % (key, draw.choice(NUMBERS)), b"\n[%s]\n" % key, b"\n[[%s]]\n" % key)
    at = text.find(b"\n", draw.randrange(len(text) + 1)) + 1
    text[at:at] = draw.choice(lines)


def _nest(draw: random.Random, text: bytearray) -> None:
    depth = draw.choice((3, 30, 90, 300, 1000, 20_000))
    deep = (
        b"[" * depth + b"]" * depth,
        b"{a=" * depth + b"1" + b"}" * depth,
        b".".join([b"a"] * depth) + b" = 1",
        b"[" + b'."b"'.join([b"a"] * depth) + b"]\n",
    )
    at = draw.randrange(len(text) + 1)
    text[at:at] = draw.choice((b"\n", b"\nq = ", b"")) + draw.choice(deep) + draw.choice((b"", b"\n"))


def _flood(draw: random.Random, text: bytearray) -> None:
    """Append very many keys, tables or items."""
    item, count = draw.choice((b"k%d = 1\n", b"[t%d]\n", b"q.k%d = 1\n", b'"%d s",')), draw.choice((100, 2_000))
    text += b"\n" + draw.choice((b"", b"[grid]\n", b"[output]\ntimes = [\n")) + b"".join(item % i for i in range(count))
    text += draw.choice((b"", b"]", b"\n"))


def _encode(draw: random.Random, text: bytearray) -> None:
    """Encode the text, or end its lines, as other editors and systems do."""
    changed = draw.choice(
        (
            b"\xef\xbb\xbf" + text,
            text.replace(b"\n", b"\r\n"),
            text.replace(b"\n", b"\r"),
            text.decode("utf-8", "replace").encode("utf-16"),
            text.decode("utf-8", "replace").encode("latin-1", "replace"),
            text.rstrip(b"\n"),
            text.replace(b"    ", b"\t"),
        )
    )
    text[:] = changed


MUTATIONS: tuple[Mutation, ...] = (
    _flip, _flip, _delete, _delete, _repeat, _splice, _strange, _strange, _number, _number, _habit, _line, _nest,
    _flood, _encode,
)  # fmt: skip
