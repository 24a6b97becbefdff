"""How people get about: paths, scripts, giving way."""
