"""Tables and plots of metrics, for papers and for the terminal."""
