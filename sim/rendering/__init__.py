"""Rendering of parts, depths and normals: the ray caster, and TinyRenderer as a reference."""
