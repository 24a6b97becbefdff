"""Re-identification of people by appearance, however long they were absent."""
