"""Judges a bag: will rosbag, rviz, Foxglove, PlotJuggler and evo take it, and why not."""

from thbridge.analysis.check.finding import BagTool, Finding, FindingSeverity
from thbridge.analysis.check.judge import Judgement, judge

__all__ = ["BagTool", "Finding", "FindingSeverity", "Judgement", "judge"]
