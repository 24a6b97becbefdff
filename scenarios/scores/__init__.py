"""How well a run went, in figures."""
