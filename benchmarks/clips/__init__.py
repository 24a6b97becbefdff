"""Real thermal clips with truth as a bench, for our trackers and for OpenCV's HOG with ByteTrack."""
