"""greywhale: open firmware and tuner for leader-follower robot arms read by potentiometers and moved by DC motors."""
