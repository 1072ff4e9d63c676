"""Pictures of recordings."""

from greywhale.report.follow import Trace, draw_following, trace

__all__ = ["Trace", "draw_following", "trace"]
