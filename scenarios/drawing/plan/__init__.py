"""The plan of a scenario: what stands where, who walks and what is moved, from above."""
