"""The panoramic tracker of several people, for a standing or moving robot."""
