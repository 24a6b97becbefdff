"""How near rendered thermal pictures come to real ones: figures, a page, and a classifier as the judge."""
