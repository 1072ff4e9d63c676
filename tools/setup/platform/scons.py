# The scons.py that PlatformIO starts: runs the SCons installed beside it.
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))

import SCons.Script.Main

SCons.Script.Main.main()
