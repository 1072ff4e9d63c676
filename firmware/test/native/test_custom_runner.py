"""Runs the native doctest suites. Uses the system's doctest where there is one, else PlatformIO downloads it."""

from pathlib import Path

from platformio.test.runners.doctest import DoctestTestRunner

SYSTEM_HEADER = Path("/usr/include/doctest/doctest.h")  # Debian: doctest-dev


class CustomTestRunner(DoctestTestRunner):
    EXTRA_LIB_DEPS = None if SYSTEM_HEADER.is_file() else DoctestTestRunner.EXTRA_LIB_DEPS
