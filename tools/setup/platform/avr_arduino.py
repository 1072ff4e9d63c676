# SCons script of the offline `atmelavr` platform: the flags, headers and core of Debian's arduino-core-avr.
import os

from SCons.Script import DefaultEnvironment

env = DefaultEnvironment()
board = env.BoardConfig()
framework = env.PioPlatform().get_package_dir("framework-arduino-avr")
core = os.path.join(framework, "cores", board.get("build.core"))
variant = os.path.join(framework, "variants", board.get("build.variant"))
machine = ["-mmcu=$BOARD_MCU"]

env.Append(
    ASFLAGS=machine,
    ASPPFLAGS=["-x", "assembler-with-cpp"],
    CFLAGS=["-std=gnu11", "-fno-fat-lto-objects"],
    CCFLAGS=[*machine, "-Os", "-Wall", "-ffunction-sections", "-fdata-sections", "-flto"],
    # Debian's core uses DECIMAL_DIG, which avr-libc's headers do not define
    CXXFLAGS=[
        "-std=gnu++11",
        "-fno-exceptions",
        "-fno-threadsafe-statics",
        "-fpermissive",
        "-DDECIMAL_DIG=__DECIMAL_DIG__",
    ],
    LINKFLAGS=[*machine, "-Os", "-Wl,--gc-sections", "-flto", "-fuse-linker-plugin"],
    CPPDEFINES=[("F_CPU", "$BOARD_F_CPU"), "ARDUINO_ARCH_AVR", ("ARDUINO", 10808)],
    CPPPATH=[core, variant],
    LIBSOURCE_DIRS=[os.path.join(framework, "libraries")],
    LIBS=["m"],
)

# avr-gcc 5.4 warns about the core itself; only this project's own warnings are of use
core_env = env.Clone()
core_env.Append(CCFLAGS=["-w"])
core_env.BuildSources(os.path.join("$BUILD_DIR", "FrameworkArduinoVariant"), variant)
env.Prepend(LIBS=[core_env.BuildLibrary(os.path.join("$BUILD_DIR", "FrameworkArduino"), core)])
