"""Shared basis of the world and a robot's software: geometry, grids, rays, and sensor messages."""
