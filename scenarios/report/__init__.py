"""Report page about one run, or several side by side: results, failures and their causes."""
