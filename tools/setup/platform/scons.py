# The scons.py that PlatformIO starts: runs the SCons of the same Python.
import SCons.Script.Main

SCons.Script.Main.main()
