"""The report as a PDF on A4, with bookmarks; a picture keeps with its words, a table breaks only between rows."""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape

from reportlab import rl_config
from reportlab.lib import colors
from reportlab.lib.pagesizes import A4
from reportlab.lib.styles import ParagraphStyle
from reportlab.lib.units import mm
from reportlab.lib.utils import ImageReader
from reportlab.pdfbase import pdfmetrics
from reportlab.pdfbase.ttfonts import TTFont
from reportlab.pdfgen.canvas import Canvas
from reportlab.platypus import (
    CondPageBreak,
    Image,
    KeepTogether,
    LongTable,
    Paragraph,
    Preformatted,
    SimpleDocTemplate,
    Spacer,
)

from greywhale.base.formats.whole import write_whole
from greywhale.pictures.plotting import matplotlib
from greywhale_paper.pages.document import Block, Chapter, Code, Document, Entry, Picture, Sheet
from greywhale_paper.pages.numbers import keep_ranges

rl_config.useA85 = 0  # pictures as bytes: as text they are a quarter larger, and Python is slow to write it

MARGIN = 16 * mm
WIDTH = A4[0] - 2 * MARGIN
TITLE_AND_SOME_ROWS = 40 * mm
TALLEST = A4[1] - 2 * MARGIN - 40
# Matplotlib brings these, with every sign that the report needs.
FONTS = {"Body": "DejaVuSans", "Strong": "DejaVuSans-Bold", "Fixed": "DejaVuSansMono"}
PRINTED = colors.HexColor("#f6f3e8")
MOST_POINTS, GOOD_POINTS, LEAST_POINTS = 8.0, 6.8, 4.8
PADDING = 6.5
LEAST_SHARE = 0.7  # of a picture's size


def write_pdf(document: Document, path: Path) -> Path:
    """Write the PDF, whole or not at all."""
    register_fonts()
    made = io.BytesIO()
    pages = SimpleDocTemplate(
        made,
        pagesize=A4,
        leftMargin=MARGIN,
        rightMargin=MARGIN,
        topMargin=MARGIN,
        bottomMargin=MARGIN,
        title=document.title,
        author="greywhale reproduce",
        invariant=1,
    )
    story: list[Any] = [_Bookmark(document.title, 0), Paragraph(escape(document.title), _style("Strong", 15))]
    story += [Paragraph(escape(sentence), _style("Body", 9)) for sentence in document.about]
    for chapter in document.chapters:
        story += _chapter(chapter)
    pages.build(story, onFirstPage=_number, onLaterPages=_number)
    write_whole(path, lambda file: file.write(made.getvalue()))
    return path


def register_fonts() -> None:
    """Make the fonts known by the names that this module gives them."""
    for name, file in FONTS.items():
        pdfmetrics.registerFont(TTFont(name, str(Path(matplotlib.get_data_path()) / "fonts" / "ttf" / f"{file}.ttf")))


class _Bookmark(Spacer):
    """A place for the list of contents of a viewer."""

    def __init__(self, title: str, level: int) -> None:
        super().__init__(0, 0)
        self._title, self._level = title, level

    def draw(self) -> None:
        canvas = self.canv
        key = f"{self._level} {self._title}"
        canvas.bookmarkPage(key)
        canvas.addOutlineEntry(self._title, key, self._level, closed=self._level > 0)


class _Together(KeepTogether):
    """Keeps to one page, for which its picture may become a little smaller: better than a hole on the page."""

    def __init__(self, parts: list[Any]) -> None:
        super().__init__(parts)
        self._parts = parts

    def split(self, width: float, height: float) -> list[Any]:
        images = [one for one in self._parts if isinstance(one, Image)]
        if images:
            image = images[0]
            rest = sum(one.wrap(width, height)[1] + one.getSpaceAfter() for one in self._parts if one is not image)
            share = (height - rest - image.getSpaceAfter() - MARGIN / 4) / image.drawHeight
            if LEAST_SHARE <= share < 1.0:
                image.drawWidth, image.drawHeight = share * image.drawWidth, share * image.drawHeight
                return list(self._parts)
        return super().split(width, height)


def _chapter(chapter: Chapter) -> list[Any]:
    head = [_Bookmark(chapter.title, 1), Spacer(0, 14), Paragraph(escape(chapter.title), _style("Strong", 13))]
    story: list[Any] = []
    for entry in chapter.entries:
        story += _entry(entry, head)
        head = []
    return story


def _entry(entry: Entry, head: list[Any]) -> list[Any]:
    named = f"{entry.label}. {entry.title}" if entry.label else entry.title
    title = f'{escape(named)} <font name="Body" size="7" color="#777777">({escape(entry.status.value)})</font>'
    first = [*head, _Bookmark(named, 2), Spacer(0, 9), Paragraph(title, _style("Strong", 10))]
    parts: list[Any] = []
    for block in entry.blocks:
        shown = _block(block)
        if isinstance(block, Sheet):
            # A long table may break, but not between its title and its first rows.
            parts += [CondPageBreak(TITLE_AND_SOME_ROWS), *first, *shown] if first else shown
        else:
            parts.append(_Together([*first, *shown]))
        first = []
    return parts


def _block(block: Block) -> list[Any]:
    if isinstance(block, Sheet):
        return [_table(block), *(Paragraph(escape(note), _style("Body", 7, "#555555")) for note in block.notes)]
    if isinstance(block, Picture):
        return [_image(block), Paragraph(escape(block.shows), _style("Body", 7, "#555555"))]
    if isinstance(block, Code):
        return [Preformatted("\n".join(block.lines), _style("Fixed", 7))]
    return [Paragraph(escape(one), _style("Body", 8.5)) for one in block.paragraphs]


def _image(picture: Picture) -> Image:
    wide, high = ImageReader(io.BytesIO(picture.png)).getSize()
    share = min(WIDTH / wide, TALLEST / high)
    return Image(io.BytesIO(picture.png), wide * share, high * share)


def _table(sheet: Sheet) -> LongTable:
    points, widths = fit_columns(sheet)
    style: list[Any] = [
        ("FONT", (0, 0), (-1, -1), "Body", points, points * 1.25),
        ("FONT", (0, 0), (-1, 0), "Strong", points, points * 1.25),
        ("VALIGN", (0, 0), (-1, -1), "TOP"),
        ("LINEABOVE", (0, 0), (-1, 0), 0.8, colors.black),
        ("LINEBELOW", (0, 0), (-1, 0), 0.4, colors.black),
        ("LINEBELOW", (0, -1), (-1, -1), 0.8, colors.black),
        ("TOPPADDING", (0, 0), (-1, -1), 1),
        ("BOTTOMPADDING", (0, 0), (-1, -1), 1.5),
        ("LEFTPADDING", (0, 0), (-1, -1), 2.5),
        ("RIGHTPADDING", (0, 0), (-1, -1), 2.5),
    ]
    style += [("BACKGROUND", (place, 0), (place, -1), PRINTED) for place in sorted(sheet.printed)]
    cells: list[list[Any]] = [
        [_cell(name, "Strong", points, place in sheet.texts) for place, name in enumerate(sheet.columns)]
    ]
    for number, row in enumerate(sheet.rows, 1):
        if row.heading:
            style += [("SPAN", (0, number), (-1, number)), ("FONT", (0, number), (0, number), "Strong", points)]
            cells.append([row.label, *[""] * (len(sheet.columns) - 1)])
        else:
            cells.append(
                [
                    _cell(text, "Body", points, place in sheet.texts)
                    for place, text in enumerate((row.label, *row.cells))
                ]
            )
    return LongTable(cells, colWidths=widths, style=style, repeatRows=1, hAlign="LEFT", spaceBefore=3, spaceAfter=3)


def _cell(text: str, font: str, points: float, left: bool) -> Paragraph:
    style = ParagraphStyle("cell", fontName=font, fontSize=points, leading=points * 1.25, alignment=0 if left else 2)
    return Paragraph(escape(keep_ranges(text)), style)


def fit_columns(sheet: Sheet) -> tuple[float, list[float]]:
    """Type size and column widths: one line a row at a good size, else several lines, and only then small letters."""
    rows = [(row.label, *row.cells) for row in sheet.rows if not row.heading]
    columns = [(name, [row[place] for row in rows]) for place, name in enumerate(sheet.columns)]
    points = MOST_POINTS
    while True:
        wide = [_width([name], texts, points) for name, texts in columns]
        if sum(wide) <= WIDTH:
            return points, wide
        if points <= GOOD_POINTS:
            least = [_width(_parts([name]), _parts(texts), points) for name, texts in columns]
            if sum(least) <= WIDTH or points <= LEAST_POINTS:
                return points, _squeeze(wide, least)
        points = max(LEAST_POINTS, points - 0.4)


def _parts(texts: Sequence[str]) -> list[str]:
    """What must stand in one line: words, and ranges."""
    return [part for text in texts for part in keep_ranges(text).split(" ")]


def _width(heads: Sequence[str], texts: Sequence[str], points: float) -> float:
    """Of the widest text, with the cell's padding."""
    wide = [pdfmetrics.stringWidth(text, "Strong", points) for text in heads]
    wide += [pdfmetrics.stringWidth(text, "Body", points) for text in texts]
    return float(max(wide)) + PADDING


def _squeeze(wide: list[float], least: list[float]) -> list[float]:
    """The widest columns give way until all fit, down to the least of each if that is possible."""
    most = max(wide)
    while most > 1.0 and sum(max(min(one, most), floor) for one, floor in zip(wide, least, strict=True)) > WIDTH:
        most *= 0.98
    widths = [max(min(one, most), floor) for one, floor in zip(wide, least, strict=True)]
    share = min(1.0, WIDTH / sum(widths))
    return [share * one for one in widths]


def _style(font: str, points: float, colour: str = "#222222") -> ParagraphStyle:
    return ParagraphStyle(
        font, fontName=font, fontSize=points, leading=points * 1.35, textColor=colors.HexColor(colour), spaceAfter=3
    )


def _number(canvas: Canvas, pages: Any) -> None:
    canvas.setFont("Body", 7)
    canvas.drawCentredString(A4[0] / 2, 8 * mm, str(pages.page))
