"""Check of a bag: whether rosbag, rviz, Foxglove, PlotJuggler and evo accept it, and why not."""

from thbridge.analysis.check.finding import NO_TRAJECTORY, BagTool, Finding, FindingSeverity
from thbridge.analysis.check.judge import Judgement, judge

__all__ = ["NO_TRAJECTORY", "BagTool", "Finding", "FindingSeverity", "Judgement", "judge"]
