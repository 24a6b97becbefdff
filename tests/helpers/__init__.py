"""What several tests need: small worlds, drawn people, toy runs."""
