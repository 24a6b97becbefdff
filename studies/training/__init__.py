"""Training of what the trackers ship: tables, networks and the people detector."""
