"""Runs in the formats of others: their tables, and their images rendered again, as those tools read them."""
