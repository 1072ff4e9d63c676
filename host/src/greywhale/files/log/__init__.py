"""Logs of leader, follower and motor voltages as CSV: written whole or not at all, refused where doubtful."""

from greywhale.files.log.reader import Log, read_evidence, read_log
from greywhale.files.log.writer import LogWriter

__all__ = ["Log", "LogWriter", "read_evidence", "read_log"]
