"""Process finished runs: import tracks of other programs, and run the scene model on their images."""
