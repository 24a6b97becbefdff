"""Compare rendered thermal images with real ones: statistics, a page, and a classifier."""
