"""What happened in a run: who was hidden, lost and swapped, and why."""
