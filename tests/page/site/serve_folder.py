"""A plain web server of this machine for a folder of files."""

from __future__ import annotations

import contextlib
import functools
import threading
from collections.abc import Iterator
from dataclasses import dataclass
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path


@dataclass(frozen=True)
class Site:
    """Where the folder is handed out, and what the page's address says beyond that."""

    port: int
    said: str = ""

    @property
    def page_address(self) -> str:
        return f"http://127.0.0.1:{self.port}/{self.said}"


class _Quiet(SimpleHTTPRequestHandler):
    def log_message(self, format: str, *words: object) -> None: ...


@contextlib.contextmanager
def serve(folder: Path) -> Iterator[Site]:
    server = ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(_Quiet, directory=str(folder)))
    thread = threading.Thread(target=server.serve_forever, args=(0.05,))
    thread.start()
    try:
        yield Site(server.server_port)
    finally:
        server.shutdown()
        thread.join()
        server.server_close()
