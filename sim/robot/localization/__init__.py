"""Localization: estimates of a robot's pose by particle filter, by Kalman filter, or from the truth for comparison."""
