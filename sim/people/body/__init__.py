"""One person's body: bones, shapes, clothes, postures and gait."""
