"""Programs that build, generate, prove, benchmark and attack greywhale; nothing of it is installed."""

from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
BUILT_FIRMWARE = ROOT / "firmware/.pio/build"  # the firmware for each board, in a folder each
BUILT_BY_SYSTEM = ROOT / "build/firmware-system"  # the same by the system's avr-gcc, where checks are set up
AVR_TOOLS = ROOT / "build/avr/bin"  # avr-gcc and its kin, those that made BUILT_FIRMWARE: the set-up links them


def avr_tool(name: str) -> str:
    """The command of one of the AVR_TOOLS."""
    return str(AVR_TOOLS / name)
