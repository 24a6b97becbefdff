"""Small networks that look again, and closer, at what trees propose."""
