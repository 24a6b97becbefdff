"""The pictures of the site, each drawn by the code that it explains: `python -m docs.generate.pictures`."""
