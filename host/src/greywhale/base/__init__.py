"""The ground floor of the package: errors, files on the disk, processes, repeated studies."""
