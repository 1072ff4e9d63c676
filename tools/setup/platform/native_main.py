# SCons script of the offline `native` platform: programs for this computer, with the system's compilers.
from SCons.Script import AlwaysBuild, Default, DefaultEnvironment

env = DefaultEnvironment()
env.Replace(AR="gcc-ar", CC="gcc", CXX="g++", RANLIB="gcc-ranlib", SIZETOOL="size")

program = env.BuildProgram()
AlwaysBuild(env.Alias("buildprog", program))
AlwaysBuild(env.Alias("run", program, env.VerboseAction("$SOURCE", "Running $SOURCE")))
Default(program)
