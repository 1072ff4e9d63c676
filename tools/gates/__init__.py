"""Gates on a compiled firmware image, from its disassembly."""
