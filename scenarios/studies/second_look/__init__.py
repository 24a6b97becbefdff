"""Teaching the network that looks again at what trees propose."""
