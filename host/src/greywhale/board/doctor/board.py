"""The board and its parameters: versions, how it started, faults, late ticks, the set that it runs, calibration."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from greywhale import __version__
from greywhale.base.errors import counted
from greywhale.board.doctor.finding import Finding, Verdict
from greywhale.board.limits import DOCTOR
from greywhale.board.pots import POTS, pots_there
from greywhale.board.refusal import fault_text, upper_first
from greywhale.files.parameter_file import load_stated, not_in
from greywhale.protocol import schema
from greywhale.protocol.joints import ALL, named, unused
from greywhale.protocol.table import ParameterTable, physical

_MOST_SHOWN = 3  # differences that are told one by one
_FLASH = "Flash this host's firmware with `greywhale flash`."
_STARTS = {
    schema.ResetCause.BROWN_OUT: (
        "Its supply sank: give the motors a supply of their own, with a common ground, and a large capacitor."
    ),
    schema.ResetCause.WATCHDOG: "Look for noise on its supply and reset line; if it comes back, report it.",
}


def examine_hello(hello: schema.HelloReply, firmware_version: str) -> list[Finding]:
    """The firmware's version, and where its set came from. (Another schema is refused when the port is opened.)"""
    mine = str(__version__)
    same = mine.split(".")[:3] == firmware_version.split(".")
    firmware = Finding(
        "firmware",
        Verdict.GOOD if same else Verdict.NOTE,
        f"{hello.board.description}, firmware {firmware_version}, this host {mine}; both speak schema "
        f"{hello.schema_hash:#010x}.",
        "" if same else _FLASH,
    )
    if hello.param_source is schema.ParamSource.DEFAULTS:
        source = Finding(
            "stored set",
            Verdict.NOTE,
            "It started from its built-in parameters: nothing valid was stored then.",
            "Store some with `greywhale upload`, `greywhale params set` or `greywhale params restore`.",
        )
    else:
        source = Finding("stored set", Verdict.GOOD, f"It started from {hello.param_source.description}.")
    return [firmware, source]


def examine_status(hello: schema.HelloReply, status: schema.StatusReply) -> list[Finding]:
    """Findings on the board's start, its fault and late ticks."""
    remedy = _STARTS.get(hello.reset_cause, "")
    start = Finding(
        "last start",
        Verdict.BAD if remedy else Verdict.GOOD,
        f"{upper_first(hello.reset_cause.description)}, {status.tick / 1000:.1f} s ago.",
        remedy,
    )
    if status.fault is schema.Fault.NONE:
        fault = Finding("fault", Verdict.GOOD, "None.")
    else:
        fault = Finding("fault", Verdict.BAD, upper_first(fault_text(status)))
    late = Finding(
        "ticks",
        Verdict.BAD if status.late_ticks else Verdict.GOOD,
        f"{status.late_ticks} late; the longest took {status.tick_us_max} of 1000 us.",
        "Flash the firmware again, and report it if ticks are still late." if status.late_ticks else "",
    )
    return [start, fault, late, _wear(status.saves)]


def _wear(saves: int) -> Finding:
    """The used share of the EEPROM's life. Banks take turns, and a save writes one cell of its bank twice: the first.

    So no cell is written more often than there were saves.
    """
    if saves == 0:
        return Finding("EEPROM", Verdict.GOOD, "No set is stored: nothing is worn.")
    share = 100.0 * saves / DOCTOR.eeprom_writes
    much = f"{share:.1f} %" if share >= 0.1 else "less than 0.1 %"
    times = f"{saves:,} save{'' if saves == 1 else 's'}"
    usage = f"{times}: {much} of the {DOCTOR.eeprom_writes:,} writes that a cell is made for."
    if saves < DOCTOR.many_saves:
        return Finding("EEPROM", Verdict.GOOD, usage)
    return Finding(
        "EEPROM",
        Verdict.NOTE,
        f"{usage} The count begins anew after 65,535.",
        "Save more seldom (a set that only runs is not stored: `greywhale commission` tries them so), or plan another "
        "board.",
    )


def examine_supply(table: ParameterTable, measured_v: float | None) -> Finding:
    """Compare the motors' supply as the board takes it with the voltage that somebody measured there."""
    counts = f"The board counts on {table.supply_v:g} V for the motors"
    if measured_v is None:
        return Finding("supply", Verdict.GOOD, f"{counts}; it cannot measure them (--supply VOLTS compares).")
    if abs(table.supply_v - measured_v) <= DOCTOR.supply_share * measured_v:
        return Finding("supply", Verdict.GOOD, f"{counts}, and they have {measured_v:g} V.")
    return Finding(
        "supply",
        Verdict.BAD,
        f"{counts}, not {measured_v:g} V.",
        f"Every voltage would be {measured_v / table.supply_v:.2g} times what it should be: set it with `greywhale "
        f"params set supply_mv={1000.0 * measured_v:.0f}`, or give the motors {table.supply_v:g} V.",
    )


def examine_table(table: ParameterTable, path: Path | None) -> list[Finding]:
    """The running set against its file, and whether potentiometers were ever calibrated."""
    findings = [] if path is None else [_against(table, load_stated(path), path)]
    return [*findings, *_joints(table), _calibration(table)]


def _joints(table: ParameterTable) -> list[Finding]:
    """Nothing about a whole arm."""
    if table.joints_in_use == ALL:
        return []
    if not table.joints_in_use:
        remedy = "Tell the board which joints there are: `greywhale calibrate --joints 0,1`."
        return [Finding("joints", Verdict.BAD, "No joint is in use: every follower's scale is 0.", remedy)]
    idle = unused(table.joints_in_use)
    text = f"{upper_first(named(idle))} {'is' if len(idle) == 1 else 'are'} not in use (follower's scale 0)."
    return [Finding("joints", Verdict.GOOD, text)]


def _against(table: ParameterTable, wanted: Mapping[str, int], path: Path) -> Finding:
    names = [name for name, raw in wanted.items() if table[name] != raw]
    silent = not_in(wanted)
    if not names:
        of_all = f" It is older and says nothing of {counted(len(silent), 'parameter')}." if silent else ""
        return Finding("parameters", Verdict.GOOD, f"The board runs what {path} says (CRC {table.crc:#06x}).{of_all}")
    shown = ", ".join(_difference(name, table, wanted) for name in names[:_MOST_SHOWN])
    more = f" and {len(names) - _MOST_SHOWN} more" if len(names) > _MOST_SHOWN else ""
    return Finding(
        "parameters",
        Verdict.BAD,
        f"Not as in {path}: {shown}{more}.",
        "`greywhale params diff FILE` shows all; `greywhale params restore FILE` stores the file's.",
    )


def _difference(name: str, table: ParameterTable, wanted: Mapping[str, int]) -> str:
    parameter = schema.PARAMETER_BY_NAME[name]
    return f"{name} is {physical(parameter, table[name]):g}, not {physical(parameter, wanted[name]):g}"


def _calibration(table: ParameterTable) -> Finding:
    shipped: Mapping[str, int] = ParameterTable.defaults().by_name()
    plain = [pot for pot in POTS if all(table[f"{pot}.{key}"] == shipped[f"{pot}.{key}"] for key in ("zero", "scale"))]
    if not plain:
        there = "All eight potentiometers" if len(pots_there(table)) == len(POTS) else "All potentiometers in use"
        return Finding("calibration", Verdict.GOOD, f"{there} have a zero or scale of their own.")
    return Finding(
        "calibration",
        Verdict.NOTE,
        f"{counted(len(plain), 'potentiometer')} {'has' if len(plain) == 1 else 'have'} the shipped zero and scale "
        f"({', '.join(plain)}): right for a 300 degree track mounted in its middle only.",
        "If they are mounted otherwise, run `greywhale calibrate`.",
    )
