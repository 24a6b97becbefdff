"""What light does between surfaces, in images of full detail: mirrors, and shadows where things touch."""
