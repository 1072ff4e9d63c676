"""How PlatformIO runs the suites: doctest programs on this computer, on-target ones with test_testing_command.

An on-target suite prints Unity's lines (`file.cpp:12:name:PASS`, `...:FAIL: why`, at its end `3 Tests 0 Failures 0
Ignored`) but needs no Unity. A suite passes only if it ran to its end and every case it counts was heard.
"""

import re
import subprocess
import threading
from pathlib import Path
from subprocess import PIPE, STDOUT

import click
from platformio.test.exception import UnitTestSuiteError
from platformio.test.result import TestStatus
from platformio.test.runners.base import TestRunnerBase
from platformio.test.runners.doctest import DoctestTestCaseParser, DoctestTestRunner
from platformio.test.runners.unity import UnityTestRunner

SYSTEM_DOCTEST = Path("/usr/include/doctest/doctest.h")  # Debian: doctest-dev; elsewhere PlatformIO downloads it
COUNT = re.compile(r"^(?:\[doctest\] test cases: *(\d+)|(\d+) Tests \d+ Failures \d+ Ignored)", re.MULTILINE)
TIME_LIMIT_S = 600


class CustomTestRunner(TestRunnerBase):
    TESTCASE_PARSE_RE = UnityTestRunner.TESTCASE_PARSE_RE
    parse_unity_line = UnityTestRunner.parse_test_case

    def __init__(self, *args, **kwargs):
        super().__init__(*args, **kwargs)
        self.on_target = self.platform.is_embedded()
        self.parse = self.parse_unity_line if self.on_target else DoctestTestCaseParser().parse
        if not self.on_target and not SYSTEM_DOCTEST.is_file():
            self.EXTRA_LIB_DEPS = DoctestTestRunner.EXTRA_LIB_DEPS

    def stage_uploading(self):
        """The simulated board reads the ELF itself, so on target building takes the place of uploading."""
        if self.on_target:
            self.options.without_uploading = True
            self.stage_building()

    def stage_testing(self):
        if self.options.without_testing:
            return
        output = []
        with subprocess.Popen(self.command(), stdout=PIPE, stderr=STDOUT, text=True, errors="replace") as program:
            watchdog = threading.Timer(TIME_LIMIT_S, program.kill)
            watchdog.start()
            for line in program.stdout:
                output.append(line)
                self.show(line)
            program.wait()
            watchdog.cancel()
        self.check_end(program.returncode, output)

    def command(self):
        """What to start: the setting of the environment, or the program built for this computer."""
        build = Path(self.project_config.get("platformio", "build_dir")) / self.test_suite.env_name
        custom = self.project_config.get(f"env:{self.test_suite.env_name}", "test_testing_command")
        return [*(custom or [str(build / "program")]), *(self.options.program_args or [])]

    def show(self, line):
        if self.options.verbose:
            click.echo(line, nl=False)
        if case := self.parse(line):
            self.test_suite.add_case(case)
            if not self.options.verbose:
                click.echo(case.humanize())

    def check_end(self, exit_code, output):
        """A program that fails, stops half-way or says less than it counts is a failure, not a shorter suite."""
        counts = [int(found[1] or found[2]) for found in COUNT.finditer("".join(output))]
        heard = len(self.test_suite.cases)
        failed = any(case.status in (TestStatus.FAILED, TestStatus.ERRORED) for case in self.test_suite.cases)
        complete = len(counts) == 1 and heard >= max(counts[0], 1)  # doctest's subcases are heard one by one
        if complete and (exit_code == 0 or failed):
            return
        click.echo("".join(output[-20:]))
        counted = counts[-1] if counts else "no"
        raise UnitTestSuiteError(f"It ended with code {exit_code}, counted {counted} cases, and {heard} were heard.")
