"""A connected board: requests, samples, recordings, parameter sets, flashing."""
