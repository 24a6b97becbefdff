"""Images of many worlds, made together."""
