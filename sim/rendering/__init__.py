"""What lies behind each pixel: the ray caster, and TinyRenderer beside it."""
