"""What a report draws: timelines, curves, ways, stills."""
