"""Scenario files: what they may say, reading, checking, and building worlds from them."""
