"""Training of the detector of people in thermal images: cascade, rescoring and box refinement."""
