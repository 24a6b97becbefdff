"""The commands of `peopleboy`, one file for each kind of work; each imports its dependencies when called."""
