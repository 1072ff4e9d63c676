"""Follows which parameter set a board would start with, as far as its frames tell: the link itself cannot read it."""

from __future__ import annotations

from greywhale.protocol import schema
from greywhale.protocol.frames import Frame


class StoredSet:
    """Hears every frame of one board. `crc` is that of the stored set, None until the board has started or stored."""

    def __init__(self) -> None:
        self.crc: int | None = None
        self._being_stored: int | None = None

    def hear(self, frame: Frame) -> bool:
        """Take a frame; whether more is known since."""
        before = self.crc
        match frame.type, len(frame.payload):
            case schema.HelloReply.TYPE, schema.HelloReply.SIZE if (
                frame.seq == 0
            ):  # it starts with the set that it stores
                self.crc, self._being_stored = schema.HelloReply.unpack(frame.payload).param_crc, None
            case schema.ParamSaveReply.TYPE, schema.ParamSaveReply.SIZE:
                self._being_stored = schema.ParamSaveReply.unpack(frame.payload).param_crc
            case schema.StatusReply.TYPE, schema.StatusReply.SIZE if self._being_stored is not None:
                state = schema.StatusReply.unpack(frame.payload).save_state
                if state is schema.SaveState.SAVED:
                    self.crc = self._being_stored
                if state is not schema.SaveState.SAVING:
                    self._being_stored = None
        return self.crc != before
