"""Check that rosbag, rviz, Foxglove, PlotJuggler and evo can read a bag, with reasons if a tool cannot."""

from thbridge.analysis.check.finding import NO_TRAJECTORY, BagTool, Finding, FindingSeverity
from thbridge.analysis.check.judge import Judgement, judge

__all__ = ["NO_TRAJECTORY", "BagTool", "Finding", "FindingSeverity", "Judgement", "judge"]
