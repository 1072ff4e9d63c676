"""Browsers that keep nothing for a page: scripts that run in it first."""

from __future__ import annotations

KINDS = ("localStorage", "sessionStorage", "indexedDB", "caches")


def _instead(get: str) -> str:
    return "".join(f"Object.defineProperty(window, '{kind}', {{ get() {{ {get} }} }});" for kind in KINDS)


FORBIDDEN = _instead("throw new DOMException('denied', 'SecurityError');")
NONE = _instead("return null;")
FULL = "Storage.prototype.setItem = () => { throw new DOMException('full', 'QuotaExceededError'); };"
