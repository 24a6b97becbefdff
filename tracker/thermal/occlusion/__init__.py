"""Who is in front of whom: by feet, by looks, or as learned; and what is seen of those behind."""
