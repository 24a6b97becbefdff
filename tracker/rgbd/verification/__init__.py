"""Whether what has the size of a human looks like one."""
