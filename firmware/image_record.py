# PlatformIO script: lets the image carry the digest of its sources, for src/image_record.cpp.
import sys

Import("env", "projenv")  # noqa: F821 (given by SCons)

sys.path.insert(0, env.subst("$PROJECT_DIR"))  # noqa: F821
sys.dont_write_bytecode = True
from pathlib import Path  # noqa: E402

from source_digest import FIRMWARE, source_digest  # noqa: E402

projenv.Append(CPPDEFINES=[("GREYWHALE_SOURCE_DIGEST", env.StringifyMacro(source_digest(Path(FIRMWARE))))])  # noqa: F821
# Nothing in the program refers to the record, so the linker is told that it is wanted.
env.Append(LINKFLAGS=["-Wl,--undefined=image_record"])  # noqa: F821
