"""Who is in front of whom: by feet, by looks, or as learned; and what becomes of those who are hidden."""
