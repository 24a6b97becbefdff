"""What a scenario file may say: every key with its unit, its limits, its default and its meaning.

Lengths in metres, angles in degrees, times in seconds, temperatures in degC: the key's last letters say so.
x points forward from where the place begins, y to the left; headings count from x to the left.
"""
