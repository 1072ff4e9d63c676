"""The bench: a simulated Arduino, an arm, a leader and a serial port, in real time or as fast as possible."""
