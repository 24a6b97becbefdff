"""People who are known again by their appearance, however long they were away."""
