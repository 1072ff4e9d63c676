"""Writes a document as one HTML file and as a PDF; the same document gives the same files, byte for byte."""
