"""How people look where everything is drawn finely: usual clothes, warmth, folds, faces, hair."""
