"""Bad CSV is named by file, line and column."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from greywhale.base.errors import UserError
from greywhale.base.formats import csv_file, toml_file
from greywhale.files.leader import load_leader

COLUMNS = ("time_s", "a")


def read(folder: Path, content: str | bytes) -> csv_file.CsvTable:
    path = folder / "f.csv"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return csv_file.read(path, COLUMNS)


def read_all(folder: Path, content: str | bytes) -> None:
    table = read(folder, content)
    table.increasing("time_s")
    table.numbers("a")


def test_comments_blank_lines_and_windows_line_ends_are_taken(tmp_path: Path) -> None:
    table = read(tmp_path, "\ufeff# one: 1\r\n#two\r\ntime_s, a\r\n0,1.5\r\n\r\n1,-2e3\r\n")
    assert table.comments == ("one: 1", "two")
    assert list(table.increasing("time_s")) == [0.0, 1.0]
    assert list(table.numbers("a")) == [1.5, -2000.0]
    assert table.lines == (4, 6)


@pytest.mark.parametrize(
    "content",
    [
        "# one: 1,,\r\n#two,,,,\r\ntime_s,a\r\n0,1.5\r\n1,-2e3\r\n",
        '"# one: 1",\n"#two"\n"time_s","a"\n"0","1.5"\n"1","-2e3"\n',
        "# one: 1;\n#two;;\ntime_s;a\n0;1,5\n1;-2e3\n",
        '"# one: 1";\n#two\ntime_s;a;;\n0;"1,5";;\n;;;\n1;-2e3\n',
        "# one: 1|\n#two||\ntime_s|a\n0|1,5\n1|-2e3\n",
        "# one: 1\t\n#two\t\ntime_s\ta\n0\t1.5\n1\t-2000.0\n",
        "# one: 1\n#two\ntime_s\ta\n0,0\t1,5\n1,0\t-2000\n",
        "# one: 1\n#two\ntime_s,a\n# here I pushed,\n0,1.5\n\n  # and here\n1,-2e3,\n# end",
        '# one: 1\n#two\n,\ntime_s , a,,\n 0, 1.5\n,\n"# here, too",\n1,-2e3\n"# end"',
    ],
)
def test_what_spreadsheets_and_people_make_of_it_is_read_alike(tmp_path: Path, content: str) -> None:
    for begin in ("", "\ufeff"):
        table = read(tmp_path, begin + content)
        assert table.comments == ("one: 1", "two")
        assert list(table.increasing("time_s")) == [0.0, 1.0]
        assert list(table.numbers("a")) == [1.5, -2000.0]


def test_a_line_that_names_the_separator_is_no_row(tmp_path: Path) -> None:
    for begin in ("sep=;", '"sep=;"', "SEP=;"):
        table = read(tmp_path, f"{begin}\r\ntime_s;a\r\n0;1,5\r\n")
        assert list(table.numbers("a")) == [1.5]


def test_a_comment_keeps_its_own_commas_and_quotes(tmp_path: Path) -> None:
    content = '# gaps: 2: 1 s, 2 s,,\n"# said ""a, b""",,\n"# gaps: 1"," b",\ntime_s,a\n0,1\n'
    assert read(tmp_path, content).comments == ("gaps: 2: 1 s, 2 s", 'said "a, b"', "gaps: 1, b")


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("", "the file has no columns; it must start with time_s,a"),
        ("# only\n", "the file has no columns"),
        ("time_s,b\n0,1\n", "line 1: column a is missing; the columns must be time_s,a"),
        ("time_s,a,b\n0,1,2\n", "line 1: column 'b' is unknown"),
        ("# a model\n\nname = 'arm'\n", ": this is TOML, but a log or a motion (CSV) is needed here."),
        ("a,time_s\n0,1\n", "line 1: the columns are not in order"),
        ("time_s,a\n", "0 rows of data, but at least 1 are needed"),
        ("# c\ntime_s,a\n0,1\n1\n", "line 4: 1 value where 2 columns are named"),
        ("time_s,a\n0,'x\n", 'line 2, column a: "\'x" is not a number'),
        ("time_s,a\n0,\n", "line 2, column a: '' is not a number"),
        ("time_s,a\n0,nan\n", "line 2, column a: nan is not a finite number"),
        ("time_s,a\n0,\u0661\n", "line 2, column a: '\u0661' is not a number"),
        ("time_s,a\n0,1_0\n", "line 2, column a: '1_0' is not a number"),
        ("time_s,a\n0,1e999\n", "line 2, column a: 1e999 is not a finite number"),
        ("time_s,a\n0,1\n\n0,1\n", "line 4, column time_s: time must increase, but 0 follows 0"),
        (
            "time_s,a\n0,1\n1e-7,1\n",
            "line 3, column time_s: time must increase by a microsecond or more, but 1e-7 follows",
        ),
        ("time_s,a\n0,1\ninf,1\n", "line 3, column time_s: inf is not a finite number"),
        ("time_s,a\n0,1\n1e15,1\n", "line 3, column time_s: 1e15 s is beyond 1e+10 s; times are in s"),
        ("time_s,a\n-1e308,1\n0,1\n", "line 2, column time_s: -1e308 s is beyond 1e+10 s"),
        ('time_s,a\n0,"1"2\n', "line 2: not valid CSV"),
        ("time_s,a\n0,1\n# x\n1,2\ntime_s,a\n2,3\n", "line 5: the column names stand here again, as where two files"),
        ("time_s;a\n0;1\ntime_s;a\n0;1\n", "line 3: the column names stand here again"),
        ("time_s,a\n0,0,1,5\n", "line 2: 4 values where 2 columns are named; if its decimal marks are commas"),
        ('time_s,a\n0,"1,5"\n', "column a: '1,5' is not a number; numbers have a decimal point"),
        ("time_s;a\n0.5;1\n1,5;2\n", "f.csv: its numbers have commas and points, so nobody knows which"),
        ("time_s\ta\n0\t1.234,5\n", "its numbers have commas and points"),
        ("time_s;b\n0;1\n", "line 1: column a is missing; the columns must be time_s,a"),
        (
            ",time_s,a\n0,0,1\n",
            "line 1: column 1 has no name, as the numbers of rows that some programs add; leave it out",
        ),
        ("Time_s,a\n0,1\n", "line 1: column time_s is missing, but there is 'Time_s'; the columns must be"),
        ("time_s,a\n0,1\n".encode("utf-16"), "byte 0 is not UTF-8; save it as CSV in UTF-8"),
        ("time_s a\n0 1\n", "line 1: the columns are separated by blanks; save it with commas"),
        ("# time_s,a\n0,1\n", "line 2: the column names above stand behind a #; take it away."),
        ("# time_s a\n0 1\n", "line 2: the column names above stand behind a #"),
        ("# c\rtime_s,a\r0,1\r", "its lines end with CR alone"),
        (
            "time_s,a\n0,1\nhere I pushed\n1,2\n",
            "line 3: 1 value where 2 columns are named: 'here I pushed'; a comment",
        ),
        ("time_s,a\n0,1\n# x\n\n# y\n1,z\n", "line 6, column a: 'z' is not a number"),
        (f'"# {"x" * 200_000}",\ntime_s,a\n0,1\n', "line 1: not valid CSV: field larger than field limit"),
        ("time_s,a\n0,1\n1", "line 3: the file ends in the middle of this line"),
        (b"time_s,a\n0,\xff\n", "byte 11 is not UTF-8"),
    ],
)
def test_bad_files_are_named_by_line_and_column(tmp_path: Path, content: str | bytes, words: str) -> None:
    with pytest.raises(UserError) as caught:
        read_all(tmp_path, content)
    assert caught.value.message.startswith(str(tmp_path / "f.csv"))
    assert words in caught.value.message
    assert "\n" not in caught.value.message


@pytest.mark.parametrize("name", ["pipe", "/dev/zero"])
def test_what_might_never_end_is_refused(tmp_path: Path, name: str) -> None:
    os.mkfifo(tmp_path / "pipe")
    for read_it in (lambda path: csv_file.read(path, COLUMNS), toml_file.read, load_leader):
        with pytest.raises(UserError, match=f"{name}: .*not an ordinary file"):
            read_it(tmp_path / name)
