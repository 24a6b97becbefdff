"""Teaching the networks that look at crops: again at what trees propose, and closer at who was found."""
