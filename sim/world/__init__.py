"""The truth: physics, sensors with their errors, and things that stand or walk where robots drive."""
