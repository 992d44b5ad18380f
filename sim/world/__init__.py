"""The truth: physics, sensors with their noise, and things that stand or walk where robots drive."""
