"""Training of the learned models: one command, `peopleboy train MODEL`, and one module per model."""
