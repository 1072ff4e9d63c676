"""Writes a document as one HTML file and as a PDF; the same document gives the same files, byte for byte."""

from greywhale.reproduce.render.html import write_html
from greywhale.reproduce.render.pdf import write_pdf

__all__ = ["write_html", "write_pdf"]
