"""Where attention goes: whether its focus is on the right person, and whether that one is known again."""
