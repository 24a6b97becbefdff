"""What `make bench` times: the parts of a frame and the whole loop, each beside a peer in the same run."""
