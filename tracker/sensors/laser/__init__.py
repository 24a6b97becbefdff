"""The laser sensor: people by their legs in the scans of a laser range finder."""
