"""Where a robot believes it is: particle filter, Kalman filter, or the truth for comparison."""
