"""A document as HTML and PDF: everything is in it, nothing else is needed, and it is the same every time."""

from __future__ import annotations

from html.parser import HTMLParser
from pathlib import Path

import matplotlib.pyplot as plt
import pytest

from greywhale.pictures.page import png
from greywhale_paper.pages import law, system
from greywhale_paper.pages.document import Chapter, Code, Document, Entry, Picture, Row, Sheet, Status, words
from greywhale_paper.pages.numbers import change, one, percent, several
from greywhale_paper.pages.printed import TABLE_2
from greywhale_paper.pages.tuning import quoted
from greywhale_paper.render.html import write_html
from greywhale_paper.render.pdf import LEAST_POINTS, WIDTH, fit_columns, register_fonts, write_pdf
from tests.paper.small import draw_nothing


def small() -> Document:
    figure, axes = plt.subplots(figsize=(2.0, 1.0))
    axes.plot([0, 1], [1, 0])
    many = [Row(f"row {number}", ("1 < 2 & θ", "x" * 40, "–")) for number in range(120)]
    blocks = (
        words("Less < more & θ²."),
        Code(("a = b", "  c")),
        Picture(png(figure), "A line that falls."),
        Sheet(("row", "one", "two", "three"), [Row("a heading"), *many], (1,), ("A note.",)),
    )
    entries = (Entry("Table 9", "Words", Status.COMPUTED, blocks), Entry("", "Own <b>", Status.OURS, (words("x"),)))
    return Document("A report", ("About it.",), (Chapter("Section 1", entries),))


class Reader(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.text = ""
        self.sources: list[str | None] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.sources += [value for key, value in attrs if key in ("src", "href")]

    def handle_data(self, data: str) -> None:
        self.text += data


def test_the_page_holds_everything_and_needs_no_other_file_and_is_the_same_again(tmp_path: Path) -> None:
    page, again = (write_html(small(), tmp_path / f"{name}.html").read_text(encoding="utf-8") for name in "ab")
    assert page == again
    reader = Reader()
    reader.feed(page)
    for part in ("A report", "Less < more & θ².", "  c", "1 < 2 & θ", "row 119", "A note.", "Own <b>", "computed anew"):
        assert part in reader.text
    assert reader.sources
    assert all(source is not None and source.startswith(("#", "data:image/png;base64,")) for source in reader.sources)


def test_a_long_table_goes_on_over_pages_of_the_pdf_which_is_the_same_again(tmp_path: Path) -> None:
    data, again = (write_pdf(small(), tmp_path / f"{name}.pdf").read_bytes() for name in "ab")
    assert data == again
    assert data.startswith(b"%PDF-")
    assert data.count(b"/Type /Page\n") + data.count(b"/Type /Page ") >= 2


def test_a_table_too_wide_for_all_letters_still_fits_the_page() -> None:
    register_fonts()
    points, widths = fit_columns(Sheet(("",) * 3, [Row("x" * 200, ("y" * 200, "z" * 200))]))
    assert points == LEAST_POINTS
    assert sum(widths) <= WIDTH + 1e-6


def test_a_row_with_too_few_cells_is_refused() -> None:
    with pytest.raises(ValueError, match="1 cells for 2 columns"):
        Sheet(("a", "b", "c"), [Row("x", ("1",))])


def test_numbers_are_medians_with_their_range() -> None:
    assert several([3.0, 1.0, 2.0], ".1f") == "2.0 (1.0 to 3.0)"
    assert several([2.0], ".1f") == several([2.0, 2.0], ".1f") == "2.0"
    assert several([None, None]) == one(None) == "–"
    assert "1 without" in several([1.0, None, 2.0], ".0f")
    assert percent(2.0, 1.0) == "50.0 % lower"
    assert percent(1.0, 2.0) == "100.0 % higher"


def test_a_change_too_small_to_be_seen_has_no_sign() -> None:
    assert [change(value, ".2f") for value in (1.234, -1.234, -0.001, 0.0)] == ["+1.23 %", "-1.23 %", "< 0.01 %", "0 %"]
    assert change(0.3, ".0f") == "< 1 %"
    assert (one(-0.3, ".0f"), several([-0.4, -0.2], ".0f")) == ("0", "0")


def test_what_is_quoted_is_what_the_paper_prints() -> None:
    assert len(TABLE_2["Lower bounds"].partition(" (")[0].split(",")) == 19
    assert quoted("table_9", 1, "ku_mv") == 19.8269
    assert quoted("table_9", 0, "ze_c") == 0.0
    assert quoted("table_10", 2, "pe_b") == 0.0423


def rows_of(chapter: Chapter, label: str) -> list[list[str]]:
    rows: list[list[str]] = next(one for one in chapter.entries if one.label == label).as_dict()["blocks"][0]["rows"]
    return rows


def test_the_firmwares_rules_are_the_printed_ones_and_one_value_of_table_3_differs(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    draw_nothing(monkeypatch)
    rules = rows_of(law.chapter(), "Table 6")
    assert len(rules) == 9
    assert all(printed == used for _, printed, used in rules)
    rows = rows_of(system.chapter(), "Table 3")
    assert [symbol for symbol, _, printed, used, *_ in rows if printed != used] == ["Iyy0"]
