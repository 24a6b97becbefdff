"""What stands, what was moved, and by whom: the articulated scene model of a place that one looks at."""
