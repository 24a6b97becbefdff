"""Where people may be, told by boosted trees that were taught with rendered thermal images alone."""
