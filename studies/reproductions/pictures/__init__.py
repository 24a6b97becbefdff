"""Pictures of the sources, drawn from simulated data."""
