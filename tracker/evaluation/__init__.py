"""How well people are found: thesis, paper and MOT metrics over boxes, from MOTChallenge files or arrays.

`evaluate.evaluate` composes the rest; nothing here looks at images or knows a tracker.
"""
