"""Work on finished runs: import tracks of other programs, and run the scene model over their images."""
