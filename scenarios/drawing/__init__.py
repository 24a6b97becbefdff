"""Pictures: plans, overlays, contact sheets."""
