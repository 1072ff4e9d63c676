"""Pictures of recordings."""

from greywhale.report.follow import Trace, draw_following, trace
from greywhale.report.names import distinct_names

__all__ = ["Trace", "distinct_names", "draw_following", "trace"]
