"""Whatever bytes a file holds: each reader gives a value, or the one sentence of a UserError, in a moment."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from greywhale.base.errors import UserError
from greywhale.base.formats import toml_file
from greywhale.commission.journal import NAME, CommissioningJournal
from greywhale.files import controller, parameter_file
from greywhale.files.arm import content_of, load_arm
from greywhale.files.leader import load_leader, save_leader
from greywhale.files.log import LogWriter, read_log
from greywhale.files.log.layout import Origin
from greywhale.files.paper_tables import paper_table
from greywhale.files.trajectory import Trajectory
from greywhale.protocol.table import ParameterTable
from greywhale.tune.search.journal import TuningJournal

REQUEST = {"seed": 1}
SLOWEST_S = 5.0  # of the processor; what these tests guard against took 14 s and more


def log(path: Path) -> None:
    table = ParameterTable.defaults()
    with LogWriter(path, Origin("1.2.3", "mega2560", table.crc, 20, 5, table)) as writer:
        for row in range(4):
            writer.append(row * 0.005, [0.1] * 4, [-0.1] * 4, [1.0] * 4, "following")


def book(path: Path) -> None:
    (path.parent / NAME).unlink(missing_ok=True)
    with CommissioningJournal(path.parent, REQUEST, resume=False) as one:
        one.note("before", {"stopped": ""})
    (path.parent / NAME).replace(path)


def read_book(path: Path) -> None:
    path.replace(path.parent / NAME)
    with CommissioningJournal(path.parent, REQUEST, resume=True):
        pass


def journal(path: Path) -> None:
    with TuningJournal(path, REQUEST) as one:
        one.tell("stage", np.ones((2, 13), dtype=np.int32), np.ones((2, 4)))


def read_journal(path: Path) -> None:
    TuningJournal(path, REQUEST, resume=True).close()


def leader(path: Path) -> None:
    save_leader(path, Trajectory(np.array([0.0, 1.0, 2.0]), np.full((3, 4), 0.25)))


# What writes a good file, and what reads it.
FILES: dict[str, tuple[Callable[[Path], object], Callable[[Path], object]]] = {
    "log": (log, read_log),
    "leader": (leader, load_leader),
    "arm": (lambda path: path.write_bytes(content_of("white_box")), load_arm),
    "controller": (lambda path: path.write_bytes(paper_table("table_10").read_bytes()), controller.load),
    "parameters": (lambda path: parameter_file.save(path, ParameterTable.defaults()), parameter_file.load),
    "table": (lambda path: parameter_file.save(path, ParameterTable.defaults()), parameter_file.load_table),
    "journal": (journal, read_journal),
    "book": (book, read_book),
}

# What makes files of today odd: controls, other alphabets, numbers of any size, structure without end.
ODD = st.one_of(
    st.binary(max_size=40),
    st.text(max_size=20).map(lambda text: text.encode("utf-8", "surrogatepass")),
    st.sampled_from(
        [
            b"\x1b[31m", b"\x00", b"\x9b", b"\xc2\x9b", b"\n", b"\r", b"\x0b", b",", b'"', b"'", b"#", b"=", b"[", b"{",
            b"nan", b"inf", b"-inf", b"1e308", b"1e999", b"-0", b"9" * 400, b"9" * 5000, b"[" * 300, b"{a=" * 300,
            b"a." * 300, b'"""', b"'''", b"true", b"1979-05-27", b'"\\u001b[31m"', b'"\\u009b" = 1\n',
        ]
    ),
)  # fmt: skip


def told(read: Callable[[Path], object], path: Path) -> str:
    """The sentence with which a file is refused; empty where it is taken."""
    started = time.thread_time()
    try:
        read(path)
    except UserError as error:
        assert time.thread_time() < started + SLOWEST_S
        return error.message
    return ""


@pytest.mark.parametrize("kind", FILES)
@given(st.data())
@settings(deadline=None, max_examples=40, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_a_spoilt_file_is_a_value_or_a_sentence(tmp_path: Path, kind: str, data: st.DataObject) -> None:
    write, read = FILES[kind]
    path = tmp_path / "file"
    write(path)
    content = path.read_bytes()
    for _ in range(data.draw(st.integers(1, 3))):
        start = data.draw(st.integers(0, len(content)))
        end = start + data.draw(st.sampled_from([0, 1, 5, 1000]))
        content = content[:start] + data.draw(ODD) + content[end:]
    path.write_bytes(content)
    told(read, path)


MONSTERS = {
    "brackets": (b"a = " + b"[" * 5000, "nested more than"),
    "tables": (b"a = " + b"{a = " * 5000, "nested more than"),
    "key of parts": (b".".join([b"a"] * 20_000) + b" = 1", "nested more than"),
    "key of quoted parts": (b" . ".join([b'"a"'] * 20_000) + b" = 1", "nested more than"),
    "heading of parts": (b"[" + b".".join([b"a"] * 20_000) + b"]", "nested more than"),
    "digits": (b"a = " + b"9" * 5000, "too many digits"),
    "hexadecimal digits": (b"a = 0x" + b"f" * 5000, "a is a number of 20000 bits, which is out of any range"),
    "fewer digits": (b"a = " + b"9" * 4000, "out of any range"),
    "long key": (b'"' + b"k" * 1_000_000 + b'" = 1', "kkk..."),
    "key that colours": (b'"\\u001b[31mred" = 1', '"\\u001b[31mred"'),
    "long file": (b"#" * 5_000_000, "at most"),
}


@pytest.mark.parametrize(("content", "words"), MONSTERS.values(), ids=MONSTERS)
def test_monsters_are_refused_at_once(tmp_path: Path, content: bytes, words: str) -> None:
    write, read = FILES["parameters"]
    write(tmp_path / "file")
    (tmp_path / "file").write_bytes(content + b"\n" + (tmp_path / "file").read_bytes())
    sentence = told(read, tmp_path / "file")
    assert words in sentence
    assert len(sentence) < 400


def test_dots_brackets_and_many_numbers_are_no_depth(tmp_path: Path) -> None:
    text = "# " + "a." * 100 + "[" * 100 + '\na = "' + "b." * 100 + "[" * 100 + "\"\nc = '''\n" + "[[{" * 30 + "'''\n"
    (tmp_path / "file").write_text(text)
    assert toml_file.read(tmp_path / "file") == {"a": "b." * 100 + "[" * 100, "c": "[[{" * 30}
    (tmp_path / "file").write_text("a = [" + "0.5, " * 500 + "]\nb = 1.5\n[c]\nd = [[0.5, 1.5], [2.5]]\n")
    assert toml_file.read(tmp_path / "file")["a"] == [0.5] * 500
