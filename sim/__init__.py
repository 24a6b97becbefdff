"""The simulated world: robot, people, cameras and the exact truth about them."""
