# PlatformIO script: strict warnings for this project's src/ and lib/ but not for the Arduino core. They are errors in
# our own checks alone: another compiler may know warnings that we do not.
import os

Import("env", "projenv")  # noqa: F821 (given by SCons)

STRICT = ["-Wall", "-Wextra", "-Wconversion", *(["-Werror"] if os.environ.get("GREYWHALE_WERROR") else [])]

own_libraries = env.subst("$PROJECT_DIR/lib/")  # noqa: F821
for library in env.GetLibBuilders():  # noqa: F821
    if library.path.startswith(own_libraries):
        library.env.Append(CCFLAGS=STRICT)
projenv.Append(CCFLAGS=STRICT)  # noqa: F821
