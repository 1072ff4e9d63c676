"""The wire: messages and parameters as declared, frames, the serial port, and which ports there are."""
