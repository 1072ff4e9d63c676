"""Static bounds on time and stack of a compiled firmware image, from its disassembly."""
