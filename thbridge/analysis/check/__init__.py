"""Judges a bag: will rosbag, rviz, Foxglove, PlotJuggler and evo take it, and why not."""

from thbridge.analysis.check.finding import Finding, Severity, Tool
from thbridge.analysis.check.judge import Judgement, judge

__all__ = ["Finding", "Judgement", "Severity", "Tool", "judge"]
