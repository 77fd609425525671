"""What schemathesis needs besides the description: how TOML is sent, and cases that can be run, or it would never get past the check."""

import zlib
from pathlib import Path

import schemathesis

CASES = Path(__file__).parents[2] / "data" / "cases"
GOOD = [(CASES / name).read_text() for name in ("hand_calculation.toml", "compact_tension.toml")]


@schemathesis.serializer("application/toml")
def toml(_context, value):
    return value if isinstance(value, bytes) else str(value).encode("utf-8", "surrogatepass")


@schemathesis.hook
def map_body(_context, body):
    """Every other input is one that can be run, chosen by what it was: a request that is repeated stays the same."""
    draw = zlib.crc32(repr(body).encode("utf-8", "surrogatepass")) % (2 * len(GOOD))
    if draw >= len(GOOD):
        return body
    if isinstance(body, str):
        return GOOD[draw]
    if isinstance(body, dict) and "input" in body:
        return {**{key: value for key, value in body.items() if key in ("name", "file")}, "input": GOOD[draw]}
    return body
