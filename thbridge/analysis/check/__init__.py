"""Check of a bag: whether rosbag, rviz, Foxglove, PlotJuggler and evo accept it, and why not."""

from thbridge.analysis.check.finding import BagTool, Finding, FindingSeverity
from thbridge.analysis.check.judge import Judgement, judge

__all__ = ["BagTool", "Finding", "FindingSeverity", "Judgement", "judge"]
