"""What everything else stands on: errors, files on the disk, processes, repeated studies."""
