"""The sensor of the thermal image: when to run the learned detector, and templates in between."""
