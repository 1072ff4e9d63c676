"""The goals of a set-up, each with all that those before it need."""

from enum import IntEnum


class Goal(IntEnum):
    RUN = 0  # to build greywhale and run it in a terminal
    PAGE = 1  # the page of the dashboard
    SITE = 2  # the page with a bench inside, and the documentation
    ALL = 3  # checks and tests
