"""The layouts of docs/layouts show what an exported MCAP file has: all of its columns, and nothing else."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as xml

from google.protobuf.descriptor_pb2 import FileDescriptorSet

from greywhale.files.exchange.mcap import TOPIC, schema_of
from greywhale.files.exchange.recording import Recording
from tests.files.exchange.example import example
from tools import ROOT

LAYOUTS = ROOT / "docs" / "layouts"


def fields(path: Path) -> set[str]:
    """The fields of the schema in the file."""
    (file,) = FileDescriptorSet.FromString(schema_of(Recording(example(path).log))).file
    (message,) = file.message_type
    return {field.name for field in message.field}


def test_plotjugglers(path: Path) -> None:
    """Of a splitter as many parts as it says, of a plot curves, whose names are topic/field."""
    root = xml.parse(LAYOUTS / "plotjuggler.xml").getroot()
    assert [one.tag for one in root.iterfind("./tabbed_widget/Tab/Container/*")] == ["DockSplitter"]
    for splitter in root.iter("DockSplitter"):
        count = int(str(splitter.get("count")))
        assert len(splitter) == count == len(str(splitter.get("sizes")).split(";"))
        assert splitter.get("orientation") in {"|", "-"}
    plots = list(root.iterfind(".//DockArea/plot"))
    assert [plot.get("mode") for plot in plots] == ["TimeSeries"] * 8
    curves = [str(curve.get("name")) for plot in plots for curve in plot.iterfind("curve")]
    assert sorted(curves) == sorted(f"{TOPIC}/{name}" for name in fields(path) - {"state"})


def leaves(node: Any) -> list[str]:
    """The panels of a mosaic: a name, or two parts beside each other."""
    if isinstance(node, str):
        return [node]
    assert set(node) == {"direction", "first", "second", "splitPercentage"}
    assert node["direction"] in {"row", "column"}
    return [*leaves(node["first"]), *leaves(node["second"])]


def test_foxgloves(path: Path) -> None:
    """Each panel that is placed has its settings, whose paths are topic.field."""
    layout = json.loads((LAYOUTS / "foxglove.json").read_text())
    assert sorted(leaves(layout["layout"])) == sorted(layout["configById"])
    assert {name.partition("!")[0] for name in layout["configById"]} == {"Plot", "StateTransitions"}
    paths = [one for panel in layout["configById"].values() for one in panel["paths"]]
    assert sorted(one["value"] for one in paths) == sorted(f"{TOPIC}.{name}" for name in fields(path))
    assert {one["timestampMethod"] for one in paths} == {"receiveTime"}
