"""The commands of `peopleboy`, one file for each kind of work; each loads what it needs when it is called."""
