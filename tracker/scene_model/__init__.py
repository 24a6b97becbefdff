"""The articulated scene model of an observed place: background, moved objects, and who moved them."""
