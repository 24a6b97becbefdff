"""How people are found of whom nobody knows yet."""
