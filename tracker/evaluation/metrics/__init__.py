"""The metrics by family: thesis, paper, CLEAR MOT, identity, HOTA."""
