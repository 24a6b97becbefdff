"""Where somebody is by four webcams in the corners of a room: the measurement of the 2003 paper, measured."""
