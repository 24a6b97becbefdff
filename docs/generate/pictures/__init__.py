"""Pictures of the site, drawn with the code that they explain: `python -m docs.generate.pictures`."""
