"""Runs the firmware's suites: `python -m tools.firmware_tests native|sim`. A suite that did not run has failed."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

from tools import ROOT
from tools.setup import platformio, venv

FOLDERS = {"native": "native", "sim": "target"}  # of firmware/test


def suites(environment: str) -> set[str]:
    """The suites there are, by PlatformIO's names."""
    folder = FOLDERS[environment]
    return {f"{folder}/{path.name}" for path in (ROOT / "firmware/test" / folder).glob("test_*") if path.is_dir()}


def passed(report: str) -> set[str]:
    return {suite["test_name"] for suite in json.loads(report)["test_suites"] if suite["status"] == "PASSED"}


def main(environment: str) -> int:
    report = ROOT / "build" / f"firmware_tests_{environment}.json"
    report.unlink(missing_ok=True)
    command: list[str | Path] = [
        venv.PYTHON,
        "-m",
        "platformio",
        "test",
        "--environment",
        environment,
        "--json-output-path",
        report,
    ]
    done = subprocess.run(command, cwd=ROOT / "firmware", env=platformio.full_environment(), check=False)
    wanted = suites(environment)
    missing = wanted - (passed(report.read_text(encoding="utf-8")) if report.is_file() else set())
    if missing or not wanted:
        print(f"Not passed: {', '.join(sorted(missing)) or 'there is no suite at all'}.", file=sys.stderr)
    return 1 if done.returncode or missing or not wanted else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
