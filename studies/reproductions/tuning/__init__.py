"""One parameter of the thesis's tracker after the other, by area accuracy."""
