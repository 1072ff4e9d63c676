"""The sentences of errors: each is a whole one (tests/conftest.py looks at all), and a test compares what it names."""

from __future__ import annotations

import re

# A name or a value that is missing from a sentence.
HOLE = re.compile(r"``|(?<!\w)\(\)|\bNone\b|\{\w+\}|  |^:|: [.:]")


def is_sentence(message: str) -> bool:
    """True if an error is one printable line that ends, with a value wherever it has room for one."""
    return message.isprintable() and message.endswith((".", "?")) and not HOLE.search(message)


def names(sentence: str, things: str) -> bool:
    """True if a sentence has these words and values in this order, each of them whole: no 3 within 30 or 3.5."""
    whole = (rf"(?<!\w)(?<!\d\.){re.escape(thing)}(?!\w|\.\d)" for thing in things.split())
    return re.search(".*".join(whole), sentence, re.DOTALL) is not None
