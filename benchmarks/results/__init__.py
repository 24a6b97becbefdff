"""The measured figures that the documentation gives: kept in one file, taken in from what commands leave."""
