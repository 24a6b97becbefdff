"""The tables and figures of the two sources, measured again: what is wanted, how it is measured, one page."""
