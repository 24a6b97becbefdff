"""What stands in kitchens, workshops, garages and streets, and the street itself."""
