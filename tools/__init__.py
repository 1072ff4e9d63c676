"""What builds, generates, proves, benchmarks and attacks greywhale; nothing of it is installed."""

from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
BUILT_FIRMWARE = ROOT / "firmware/.pio/build"  # the firmware for each board, in a folder each
