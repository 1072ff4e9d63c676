# SCons script of the offline `atmelavr` platform: the flags of PlatformIO's own framework. There is no core to compile:
# the firmware has a main() of its own and uses nothing of Arduino's.
from SCons.Script import DefaultEnvironment

env = DefaultEnvironment()
machine = ["-mmcu=$BOARD_MCU"]

env.Append(
    ASFLAGS=machine,
    ASPPFLAGS=["-x", "assembler-with-cpp"],
    CFLAGS=["-std=gnu11", "-fno-fat-lto-objects"],
    CCFLAGS=[*machine, "-Os", "-Wall", "-ffunction-sections", "-fdata-sections", "-flto"],
    CXXFLAGS=["-fno-exceptions", "-fno-threadsafe-statics", "-fpermissive", "-std=gnu++11"],
    LINKFLAGS=[*machine, "-Os", "-Wl,--gc-sections", "-flto", "-fuse-linker-plugin"],
    CPPDEFINES=[("F_CPU", "$BOARD_F_CPU"), "ARDUINO_ARCH_AVR", ("ARDUINO", 10808)],
    LIBS=["m"],
)
