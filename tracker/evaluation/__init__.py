"""How well people are found: thesis, paper and MOT metrics."""
