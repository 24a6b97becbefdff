"""The exact truth: who is where, what the cameras see of them, who hides whom, what happens."""
