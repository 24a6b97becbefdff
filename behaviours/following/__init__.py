"""Following a person: who it is, where it may be, how to get near."""
