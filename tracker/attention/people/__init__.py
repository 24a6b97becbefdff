"""People who are known again by their looks, however long they were away."""
