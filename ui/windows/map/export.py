"""Repair of pyqtgraph's export to SVG, which fails on the closed paths that Qt 6.11 writes.

Source: issue 3495 of pyqtgraph, which is fixed after its version 0.14.0.
"""

import importlib
from xml.dom.minidom import Element

_exporter = importlib.import_module("pyqtgraph.exporters.SVGExporter")
_correct_coordinates = vars(_exporter)["correctCoordinates"]


def repair_export() -> None:
    """Repair pyqtgraph's exporter in this process."""
    vars(_exporter)["correctCoordinates"] = _correct_open


def _correct_open(node: Element, *rest: object) -> None:
    """Remove the commands that close paths; each path ends at its first point anyway."""
    for path in node.getElementsByTagName("path"):
        path.setAttribute("d", path.getAttribute("d").replace("Z", "").strip().replace("  ", " "))
    _correct_coordinates(node, *rest)
