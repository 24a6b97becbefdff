"""One person's body: bones, shapes, skin and clothes."""
