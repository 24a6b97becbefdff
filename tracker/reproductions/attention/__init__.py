"""Visual attention: learn a person's appearance from one box, and find the person in images."""
