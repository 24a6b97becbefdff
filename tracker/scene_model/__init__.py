"""The articulated scene model of an observed place: what stands there, what was moved, and who moved it."""
