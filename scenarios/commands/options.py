"""Help texts that several commands share."""

SEED = "[default: 0, or that of a run's own scenario.yaml]"
