"""The appearance of people in full detail: usual clothes, surface temperatures, folds, faces, hair."""
