# SCons script of the offline `atmelavr` platform: avr-gcc, and the avrdude on the PATH if there is one, with
# the same targets and program names as PlatformIO's own platform.
from SCons.Script import COMMAND_LINE_TARGETS, AlwaysBuild, Builder, Default, DefaultEnvironment

env = DefaultEnvironment()
env.Replace(
    AR="avr-gcc-ar",
    AS="avr-as",
    CC="avr-gcc",
    CXX="avr-g++",
    OBJCOPY="avr-objcopy",
    RANLIB="avr-gcc-ranlib",
    SIZETOOL="avr-size",
    ARFLAGS=["rc"],
    PROGNAME="firmware",
    PROGSUFFIX=".elf",
    SIZEPROGREGEXP=r"^(?:\.text|\.data|\.bootloader)\s+(\d+).*",
    SIZEDATAREGEXP=r"^(?:\.data|\.bss|\.noinit)\s+(\d+).*",
    SIZECHECKCMD="$SIZETOOL -A -d $SOURCES",
    SIZEPRINTCMD="$SIZETOOL -A -d $SOURCES",
)
to_hex = env.VerboseAction("$OBJCOPY -O ihex -R .eeprom $SOURCES $TARGET", "Building $TARGET")
env.Append(BUILDERS={"ElfToHex": Builder(action=to_hex, suffix=".hex")})

if "nobuild" in COMMAND_LINE_TARGETS:
    elf, image = "$BUILD_DIR/${PROGNAME}.elf", "$BUILD_DIR/${PROGNAME}.hex"
else:
    elf = env.BuildProgram()
    image = env.ElfToHex("$BUILD_DIR/${PROGNAME}", elf)
    env.Depends(image, "checkprogsize")

AlwaysBuild(env.Alias("nobuild", image))
program = env.Alias("buildprog", image, image)
env.AddPlatformTarget("size", elf, env.VerboseAction("$SIZEPRINTCMD", "Calculating size $SOURCE"), "Program Size")


def find_port(target, source, env):
    """Take the port named on the command line, else the board's, and complete avrdude's options with it."""
    env.AutodetectUploadPort()
    env.Append(UPLOADERFLAGS=["-b", "$UPLOAD_SPEED", "-P", "$UPLOAD_PORT"])


env.Replace(
    UPLOADER="avrdude",
    UPLOADERFLAGS=["-p", "$BOARD_MCU", "-c", "$UPLOAD_PROTOCOL", "-D"],
    UPLOADCMD="$UPLOADER $UPLOADERFLAGS -U flash:w:$SOURCES:i",
)
upload = [
    env.VerboseAction(find_port, "Looking for upload port..."),
    env.VerboseAction("$UPLOADCMD", "Uploading $SOURCE"),
]
if env.subst("$UPLOAD_PROTOCOL") == "custom":
    del upload[0]
env.AddPlatformTarget("upload", image, upload, "Upload")

Default(program)
