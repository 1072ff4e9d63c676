"""The parameters in a log's header are those that ran, or the log is refused; logs without them are read as before."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings

from greywhale.base.errors import UserError
from greywhale.files.log import LogWriter, read_log
from greywhale.files.log.layout import Origin
from greywhale.files.log.parameters import lines_of, table_in
from greywhale.protocol import schema
from greywhale.protocol.schema import Board
from greywhale.protocol.table import ParameterTable
from tests.files.test_parameter_file import tables

TABLE = ParameterTable.defaults(Board.NANO328).with_raw({"joint1.kp": 50_000, "leader2.scale": -70})


def write(path: Path, table: ParameterTable | None = TABLE) -> Origin:
    origin = Origin("1.2.3", TABLE.board.key, TABLE.crc, 1, 1, table)
    with LogWriter(path, origin) as log:
        for row in range(3):
            log.append(row * 0.001, [0.1] * 4, [0.0] * 4, [0.0] * 4, "following")
    return origin


def facts_of(table: ParameterTable) -> dict[str, str]:
    return {key: text for key, _, text in (line.partition(": ") for line in lines_of(table))}


@given(tables())
@settings(max_examples=30, suppress_health_check=[HealthCheck.too_slow])
def test_every_raw_value_survives(values: tuple[int, ...]) -> None:
    table = ParameterTable(values)
    assert table_in(facts_of(table), "log", table.crc, table.board.key) == table


def test_a_log_gives_back_the_table_and_all_else(tmp_path: Path) -> None:
    origin = write(tmp_path / "log.csv")
    assert read_log(tmp_path / "log.csv").origin == origin
    assert write(tmp_path / "old.csv", None) == read_log(tmp_path / "old.csv").origin
    new, old = ((tmp_path / name).read_text().splitlines() for name in ("log.csv", "old.csv"))
    assert [line for line in new if not line.startswith(("# parameters", "# check"))] == [
        line for line in old if not line.startswith("# check")
    ]
    assert max(len(line) for line in new) < 500


@pytest.mark.parametrize("layout", [1, 2])
def test_a_log_from_before_a_parameter_was_added_has_its_default(layout: int) -> None:
    newer = tuple(one.name.rpartition(".")[2] for one in schema.PARAMETERS if one.since > layout)
    facts = {
        key: " ".join(one for one in text.split() if not one.startswith(newer)) for key, text in facts_of(TABLE).items()
    }
    assert table_in(facts, "log", 0x1234, TABLE.board.key) == TABLE


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("kp=", "kq=", "joint0.kq"),
        ("supply_mv=15000", "supply_mv=\u0661", "a parameter in the header is no number: \u0661"),
        ("joint0: ", "joint7: ", "the header has the parameter joint7.ne_c, which"),
        ("period_ms=1", "period_ms=51", "period_ms is 51 ms"),
        ("period_ms=1", "period_ms=one", "a parameter in the header is no number: could not convert"),
        ("period_ms=1", "period_ms=nan", "a parameter in the header is wrong: period_ms is nan"),
        ("period_ms=1", "period_ms", "'period_ms' in the header is not NAME=VALUE"),
        ("supply_mv=15000", "supply_mv=12000", "the parameters in the header have CRC 0x"),
    ],
)
def test_a_header_that_was_changed_is_refused(tmp_path: Path, old: str, new: str, words: str) -> None:
    path = tmp_path / "log.csv"
    write(path)
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(UserError, match=f"^{path}: .*{words}"):
        read_log(path)
