"""The verbs that are killed, each with small inputs."""

from __future__ import annotations

import re
import shutil
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from greywhale.arm.export import urdf
from greywhale.files import parameter_file
from greywhale.files.arm import load_arm
from greywhale.files.leader import save_leader
from greywhale.trajectory import Trajectory
from tests.tune.models import write_model
from tools.bench.recordings import TABLES, random_arm, record_three, table_of
from tools.campaign.journal import ROOT


@dataclass(frozen=True)
class Verb:
    """A verb with small inputs. `logs` and `files` are what it promises, beside a `journal` to go on from.

    {in} in its arguments is the folder of the inputs, {port} the board's port, `needs` what it imports when it runs.
    What it computes before change number `held` (from 0) is done once for all trials, and they begin there. Where its
    results `vary` from run to run, `files` are those of a run, and each is judged by what it is. One that `refuses`
    never writes over a file, so none is put in the place of a result, and a result is taken away before the next run.
    """

    name: str
    arguments: str
    logs: dict[str, int] = field(default_factory=dict)  # rows of each, 0 where that varies
    files: tuple[str, ...] = ()
    journal: str = ""
    board: str = ""  # fake or bench
    held: int | None = None
    vary: bool = False
    refuses: bool = False
    more: str = ""  # pattern of results of which another run may have others
    needs: tuple[str, ...] = ()
    trials: int = 1000
    size: int = 250  # trials in a piece

    def may_write(self, name: str) -> bool:
        """Whether a run may leave this result out."""
        return bool(self.more and re.fullmatch(self.more, name))


_DRAWING = ("greywhale.report", "matplotlib.backends.backend_svg", "matplotlib.backends.backend_agg")
_LOOKED = 1  # the first change only looks whether a file can be written there
_LED = "-o log.csv --yes --port {port}"
VERBS = (
    Verb("record", "record -s 0.4 -o log.csv --port {port}", {"log.csv": 400}, board="fake"),
    Verb("record --enable", "record -s 0.4 --enable -o log.csv --port {port}", {"log.csv": 400}, board="fake"),
    Verb(
        "record --excite",
        f"record --excite -s 4 --budget 1 --save-motion motion.csv {_LED} --every 4",
        {"log.csv": 0},
        ("motion.csv",),
        board="fake",
        needs=("greywhale.excite", "greywhale.files.arm"),
        trials=200,
        size=50,
    ),
    Verb("record --reconnect", "record -s 0.4 --reconnect -o log.csv --port {port}", {"log.csv": 400}, board="fake"),
    Verb("replay", f"replay {{in}}/motion.csv {_LED}", {"log.csv": 0}, board="fake"),
    Verb("upload", f"upload {TABLES}/table_8.toml --port {{port}}", board="fake"),
    Verb("params set", "params set joint0.kp=0.5 supply_mv=12000 --port {port}", board="fake"),
    Verb("params restore", "params restore {in}/table.toml --port {port}", board="fake"),
    Verb("params backup", "params backup backup.toml --port {port}", files=("backup.toml",), board="fake"),
    Verb("params get", "params get --port {port}", board="fake", trials=250),
    Verb("params diff", "params diff {in}/table.toml --port {port}", board="fake", trials=250),
    Verb("info", "info --port {port}", board="fake", needs=("greywhale.doctor.board",), trials=250),
    Verb("stop", "stop --clear-fault --port {port}", board="fake", trials=250),
    Verb(
        "calibrate, the person's part left out",
        "calibrate --yes --backup before.toml --port {port}",
        files=("before.toml",),
        board="fake",
        refuses=True,
        trials=500,
    ),
    Verb(
        "arm new",
        "arm new --answers {in}/answers.toml -o arm.toml",
        files=("arm.toml",),
        refuses=True,
        needs=("greywhale.cli.arm_new",),
    ),
    Verb(
        "arm match",
        "arm match default -o matched.toml --port {port}",
        files=("matched.toml",),
        board="fake",
        refuses=True,
        needs=("greywhale.cli.arm_match",),
        trials=500,
    ),
    Verb("arm import", "arm import {in}/arm.urdf -o arm.toml", files=("arm.toml",), refuses=True),
    Verb(
        "export --fis",
        f"export --fis {TABLES}/table_8.toml --out c.fis",
        files=tuple(f"c_joint{joint}.fis" for joint in range(4)),
        needs=("greywhale.fuzzy.export_fis", "greywhale.fuzzy.settings"),
    ),
    Verb(
        "export --urdf",
        "export --urdf default --out arm.urdf",
        files=("arm.urdf",),
        needs=("greywhale.arm.export", "greywhale.files.arm"),
    ),
    Verb(
        "export --mjcf",
        "export --mjcf default --out arm.xml",
        files=("arm.xml",),
        needs=("greywhale.arm.export", "greywhale.files.arm"),
        trials=500,
    ),
    Verb(
        "evaluate --picture",
        "evaluate {in}/log.csv --picture log.svg",
        files=("log.svg",),
        held=_LOOKED,
        needs=_DRAWING,
    ),
    Verb(
        "compare",
        "compare --functions sphere --methods gwo,woa --budget 30 --seeds 2 --jobs 1 -o c.csv -o c.svg",
        files=("c.csv", "c.svg"),
        needs=("greywhale.optimise.comparison_report", *_DRAWING),
    ),
    Verb(
        "tune, its floors left out",
        "tune {in}/model.toml --method random --budget 4 --samples 1 --workers 1 -o controller.toml",
        files=("controller.toml",),
        journal="controller.toml.journal",
        needs=("greywhale.tune",),
        trials=100,
        size=25,
    ),
    Verb(
        "identify",
        f"identify {{in}}/fit.csv -v {{in}}/second.csv -c {TABLES}/before_tuning.toml -o model.toml",
        files=("model.toml",),
        held=_LOOKED,
        needs=("greywhale.identify", "greywhale.files.arm"),
        size=1000,
    ),
    Verb(
        "record --enable, simulated board",
        "record -s 0.4 --enable -o log.csv --port {port}",
        {"log.csv": 400},
        board="bench",
        trials=40,
        size=20,
    ),
    Verb("upload, simulated board", f"upload {TABLES}/table_8.toml --port {{port}}", board="bench", trials=40, size=20),
    Verb(
        "doctor, simulated board",
        "doctor --seconds 0.5 --port {port}",
        board="bench",
        needs=("greywhale.doctor",),
        trials=20,
        size=10,
    ),
    Verb(
        "doctor --image, simulated board",
        "doctor --image --seconds 0.5 --port {port}",
        board="bench",
        needs=("greywhale.doctor",),
        trials=8,
        size=4,
    ),
    Verb(
        "demo, simulated board",
        f"demo -o demo --duration 5 --controller {TABLES}/table_8.toml",
        vary=True,
        trials=10,
        size=2,
    ),
    Verb(
        "commission, simulated board",
        "commission -o c --model {in}/model.toml --rounds 1 --trials 1 --budget 4 --workers 1 --port {port}",
        journal="c/commission.json",
        more=r"c/trial-\d\d\.csv",  # how many it tries depends on what the arm did
        board="bench",
        vary=True,
        needs=("greywhale.commission", "greywhale.commission.page", "greywhale.excite"),
        trials=6,
        size=1,
    ),
)


# Verbs of the command line that are not killed, and why.
LEFT_OUT = {
    "sim": "it runs until it is ended; the next bench sweeps what a killed one leaves, and `cuts` cuts its EEPROM",
    "ports": "it neither writes a file nor opens a port",
    "udev": "it only prints",
    "flash": "avrdude and the bootloader do the work, and go on when their caller is killed",
    "reproduce": "it takes minutes; its results are a study's, like those of `compare`",
}


def make_inputs(verb: Verb, folder: Path) -> None:
    """What the verb reads."""
    if "{in}/motion.csv" in verb.arguments:
        times = np.arange(0.0, 0.3, 0.05)
        save_leader(folder / "motion.csv", Trajectory(times, 0.02 * np.sin(9.0 * times)[:, None] * np.ones(4)))
    if "{in}/model.toml" in verb.arguments:
        write_model(folder / "model.toml")
    if "{in}/fit.csv" in verb.arguments or "{in}/log.csv" in verb.arguments:
        record_three(random_arm(2), folder, seed=1, seconds=6.0)
        shutil.copy(folder / "fit.csv", folder / "log.csv")
    if "{in}/answers.toml" in verb.arguments:
        answers = (ROOT / "docs/your-arm.md").read_text(encoding="utf-8").partition("```toml\n")[2].partition("```")[0]
        (folder / "answers.toml").write_text(answers, encoding="utf-8")
    if "{in}/arm.urdf" in verb.arguments:
        (folder / "arm.urdf").write_text(urdf(load_arm("default")), encoding="utf-8")
    if "{in}/table.toml" in verb.arguments:
        parameter_file.save(folder / "table.toml", table_of("table_8"))
