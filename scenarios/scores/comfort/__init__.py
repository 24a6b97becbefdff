"""How comfortable people were with a robot that drives among them."""
