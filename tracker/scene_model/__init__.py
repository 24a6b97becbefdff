"""What stands, what was moved, and by whom: the articulated scene model of a place seen from where one stands."""
