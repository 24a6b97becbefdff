"""The single-person tracker of the OMNIVIS 2003 paper."""
