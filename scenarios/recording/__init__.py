"""A run as a rerun recording, and rerun's viewer: nothing else here imports rerun."""
