"""Where the tracker by detection looks, and by what."""
