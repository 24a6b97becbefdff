"""How well runs went, in figures, and how sure these are."""
