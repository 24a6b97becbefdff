"""The exact truth: poses of people, what the cameras see of them, occlusion, and events."""
