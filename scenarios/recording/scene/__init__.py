"""What a scene model believes, as a layer over the recording of a run."""
