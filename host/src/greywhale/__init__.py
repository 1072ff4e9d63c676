"""greywhale: open firmware and tuner for leader-follower robot arms read by potentiometers and moved by DC motors."""

# Nothing is imported here: `python -m greywhale` still has the current folder on its path, see __main__.py.
TYPE_CHECKING = False
if TYPE_CHECKING:
    __version__: str
else:

    def __getattr__(name: str) -> str:
        """Look `__version__` up when it is asked for: verbs start sooner, and a source tree needs no installation."""
        if name != "__version__":
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        from importlib.metadata import version

        return version("greywhale")
