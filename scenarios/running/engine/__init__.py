"""Many tasks, one way to work through them: here, in processes of this machine, or on a cluster."""
