"""The scene model as its source prints it (SA chapter 3), with the four backgrounds that it compares."""
