"""Runs the suites for PlatformIO: doctest programs on this computer, on-target ones with test_testing_command.

An on-target suite prints Unity's lines (`file.cpp:12:name:PASS`, `...:FAIL: why`, at its end `3 Tests 0 Failures 0
Ignored`) but needs no Unity. A suite passes only if it ran to its end and every case it counts was heard.
"""

import re
import subprocess
from pathlib import Path
from xml.etree import ElementTree

import click
from platformio.test.exception import UnitTestSuiteError
from platformio.test.result import TestCase, TestCaseSource, TestStatus
from platformio.test.runners.base import TestRunnerBase
from platformio.test.runners.doctest import DoctestTestRunner

SYSTEM_DOCTEST = Path("/usr/include/doctest/doctest.h")  # Debian: doctest-dev; elsewhere PlatformIO downloads it
TIME_LIMIT_S = 600

UNITY_CASE = re.compile(r"^(?P<file>[^:\s]+):(?P<line>\d+):(?P<name>[^:]+):(?P<status>PASS|FAIL)(:\s*(?P<why>.*))?$")
UNITY_END = re.compile(r"^(\d+) Tests (\d+) Failures \d+ Ignored")


def read_doctest(output):
    """The cases of doctest's JUnit report; none when the program died before writing it."""
    _, declaration, report = output.partition("<?xml")
    if not declaration:
        return []
    return [doctest_case(element) for element in ElementTree.fromstring(declaration + report).iter("testcase")]


def doctest_case(element):
    problems = [*element.iter("failure"), *element.iter("error")]
    why = "\n".join((problem.text or problem.get("message")).strip() for problem in problems)
    status = TestStatus.FAILED if problems else TestStatus.PASSED
    name = f"{Path(element.get('classname')).name}: {element.get('name')}"
    return TestCase(name, status, message=why.partition("\n")[2] or why or None, stdout=why)


def read_unity(output):
    """The cases an on-target suite printed; none when it stopped half-way or its own count differs."""
    matches = [match for line in output.splitlines() if (match := UNITY_CASE.match(line.strip()))]
    ends = [match for line in output.splitlines() if (match := UNITY_END.match(line.strip()))]
    if len(ends) != 1 or int(ends[0][1]) != len(matches):
        return []
    return [unity_case(match) for match in matches]


def unity_case(match):
    status = TestStatus.PASSED if match["status"] == "PASS" else TestStatus.FAILED
    source = TestCaseSource(match["file"], int(match["line"]))
    return TestCase(match["name"], status, message=match["why"] or None, source=source, stdout=match[0])


class CustomTestRunner(TestRunnerBase):
    def __init__(self, *args, **kwargs):
        super().__init__(*args, **kwargs)
        self.on_target = self.platform.is_embedded()
        if not self.on_target and not SYSTEM_DOCTEST.is_file():
            self.EXTRA_LIB_DEPS = DoctestTestRunner.EXTRA_LIB_DEPS

    def stage_uploading(self):
        """The simulated board reads the ELF itself, so on target building takes the place of uploading."""
        if self.on_target:
            self.options.without_uploading = True
            self.stage_building()

    def command(self):
        """The command to start: the setting of the environment, or the program built for this computer."""
        build = Path(self.project_config.get("platformio", "build_dir")) / self.test_suite.env_name
        custom = self.project_config.get(f"env:{self.test_suite.env_name}", "test_testing_command")
        return [*(custom or [str(build / "program"), "--reporters=junit"]), *(self.options.program_args or [])]

    def stage_testing(self):
        if self.options.without_testing:
            return
        try:
            done = subprocess.run(
                self.command(), capture_output=True, text=True, errors="replace", timeout=TIME_LIMIT_S
            )
        except subprocess.TimeoutExpired as error:
            raise UnitTestSuiteError(f"It did not end within {TIME_LIMIT_S} s.") from error
        cases = (read_unity if self.on_target else read_doctest)(done.stdout)
        for case in cases:
            self.test_suite.add_case(case)
            click.echo(case.humanize())
        failed = any(case.status == TestStatus.FAILED for case in cases)
        if self.options.verbose or not cases or (done.returncode != 0 and not failed):
            click.echo(done.stdout[-4000:] + done.stderr[-4000:])
        if not cases:
            raise UnitTestSuiteError(f"It ended with code {done.returncode} and without a whole report.")
        if done.returncode != 0 and not failed:
            raise UnitTestSuiteError(f"Its cases passed, but it ended with code {done.returncode}.")
