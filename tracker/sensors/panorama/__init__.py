"""The sensor of the panoramic camera: the foreground of people, and their places on the floor."""
