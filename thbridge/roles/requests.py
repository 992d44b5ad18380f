"""What may be asked of the robots beside the game, by whoever sits at their controls: ROS clients, windows."""

from sim.inputs import TeamInput

Request = TeamInput
"""Acts in the next tick. What is asked of a robot that is under way for the game delays its order, and no more."""
