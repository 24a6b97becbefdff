"""Tracking one person all round a standing robot with a panoramic camera, as the OMNIVIS 2003 paper does."""
