"""The pictures of the 2003 paper on a panoramic camera, drawn again."""
