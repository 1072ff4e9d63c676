"""A verb as the server starts it for a page, but the seconds of its countdown take no time."""

from __future__ import annotations

from greywhale.cli import countdown, job

countdown.SECOND_S = 0.0

if __name__ == "__main__":
    job.main()
