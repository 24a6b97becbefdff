"""What each part of the tracker by detection gives."""
