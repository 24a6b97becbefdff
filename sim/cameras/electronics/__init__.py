"""What a thermal camera's electronics make of temperatures: drift, shutter, gain, sharpening, compression."""
