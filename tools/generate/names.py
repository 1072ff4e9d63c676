"""Names as another language writes them."""

from __future__ import annotations


def camel(name: str) -> str:
    """A name of TypeScript: loadAddress for load_address."""
    first, *others = name.lower().split("_")
    return first + "".join(map(str.capitalize, others))
