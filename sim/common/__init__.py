"""What the world and a robot's software share: geometry, grids, rays, sensor messages, and keyed noise."""
